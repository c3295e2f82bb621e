#include "pipeline/store/sample_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/csv_file.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {
namespace {

// HDF5's signature may also stand further on, behind a user's block; ours and h5py's have none.
bool is_hdf5(const std::filesystem::path& path) {
  std::array<char, 4> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  return begin == std::array<char, 4>{'\x89', 'H', 'D', 'F'};
}

std::vector<Channel> columns_of(const h5::Dataset& dataset) {
  const std::vector<std::string> labels = column_labels(dataset, dataset.row_size());
  const std::vector<std::string> units = column_units(dataset, labels.size());
  std::vector<Channel> columns;
  for (std::size_t c = 0; c < labels.size(); ++c) {
    columns.push_back({labels[c], units.empty() ? "" : units[c]});
  }
  return columns;
}

SampleSet read_hdf5(const std::filesystem::path& path, const std::string& name, Index most_rows) {
  const h5::File file = h5::File::open(path);
  const h5::Dataset dataset = file.dataset(name);
  dataset.require_shape({-1, -1});
  dataset.require_readable(h5::ElementType::f64);
  SampleSet set{dataset.where(), columns_of(dataset), {}};
  set.rows.resize(std::min(most_rows, dataset.num_rows()), dataset.row_size());
  const std::span<double> all(set.rows.data(), static_cast<std::size_t>(set.rows.size()));
  dataset.read_rows<double>(0, set.rows.rows(), all);
  dataset.require_finite<double>(all);
  return set;
}

SampleSet read_csv(const std::filesystem::path& path, Index most_rows) {
  const CsvFile csv(path);
  SampleSet set{csv.name(), csv.columns(), {}};
  set.rows.resize(std::min(most_rows, csv.num_rows()), static_cast<Index>(set.columns.size()));
  for (Index i = 0; i < set.rows.rows(); ++i) {
    for (Index c = 0; c < set.rows.cols(); ++c) {
      set.rows(i, c) = csv.number(i, static_cast<std::size_t>(c));
    }
  }
  return set;
}

std::vector<std::string> labels_of(const SampleSet& set) {
  std::vector<std::string> labels;
  for (const Channel& column : set.columns) labels.push_back(column.label);
  return labels;
}

}  // namespace

SampleSet read_sample_set(const std::filesystem::path& path, const std::string& dataset,
                          Index most_rows) {
  return is_hdf5(path) ? read_hdf5(path, dataset, most_rows) : read_csv(path, most_rows);
}

SampleSet in_order_of(const SampleSet& first, SampleSet second) {
  if (first.rows.cols() != second.rows.cols()) {
    throw InputError(fmt::format("{}: {} columns, must be {} as in {}", second.where,
                                 second.rows.cols(), first.rows.cols(), first.where));
  }
  if (first.columns.empty() || second.columns.empty()) return second;
  const std::vector<std::string> labels = labels_of(second);
  std::vector<Index> order;
  for (const Channel& column : first.columns) {
    const auto found = std::ranges::find(labels, column.label);
    if (found == labels.end()) {
      throw InputError(fmt::format("{}: {}; must have those of {}", second.where,
                                   missing_name("column", column.label, labels), first.where));
    }
    const auto place = found - labels.begin();
    const std::string& unit = second.columns[static_cast<std::size_t>(place)].unit;
    if (!unit.empty() && !column.unit.empty() && unit != column.unit) {
      throw InputError(fmt::format("{}: column '{}' is in [{}], must be in [{}] as in {}",
                                   second.where, column.label, unit, column.unit, first.where));
    }
    order.push_back(place);
  }
  second.rows = second.rows(Eigen::all, order).eval();
  second.columns = first.columns;
  return second;
}

}  // namespace npdr::pipeline
