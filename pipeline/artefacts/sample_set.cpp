#include "pipeline/artefacts/sample_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "core/error.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/h5.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

// HDF5's signature may also stand further on, behind a user's block; ours and h5py's have none.
bool is_hdf5(const std::filesystem::path& path) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) return false;  // a pipe has no begin
  std::array<char, 4> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  return begin == std::array<char, 4>{'\x89', 'H', 'D', 'F'};
}

// Row i of `count` among `num_rows`. Files may claim so many that i num_rows would overflow.
Index spread_position(Index i, Index count, Index num_rows) {
  return i * (num_rows / count) + i * (num_rows % count) / count;
}

SampleSet read_hdf5(const h5::File& file, const std::string& name, Index most_rows) {
  const h5::Dataset dataset = file.dataset(name);
  dataset.require_shape({-1, -1});
  dataset.require_readable(h5::ElementType::f64);
  SampleSet set{dataset.where(), column_channels(dataset, dataset.row_size()), {}};
  const Index count = std::min(most_rows, dataset.num_rows());
  set.rows.resize(count, dataset.row_size());
  const std::span<double> all(set.rows.data(), static_cast<std::size_t>(set.rows.size()));
  if (count == dataset.num_rows()) {
    dataset.read_rows<double>(0, count, all);
  } else {
    const auto width = static_cast<std::size_t>(dataset.row_size());
    for (Index i = 0; i < count; ++i) {
      dataset.read_rows<double>(spread_position(i, count, dataset.num_rows()), 1,
                                all.subspan(static_cast<std::size_t>(i) * width, width));
    }
  }
  dataset.require_finite<double>(all);
  return set;
}

SampleSet read_csv(const std::filesystem::path& path, Index most_rows) {
  NumberTable table(path);
  const auto width = static_cast<std::size_t>(table.num_columns());
  SampleSet set{table.name(), table.columns(), {}};
  std::vector<double> all;
  Index count = 0;
  for (; table.next(); ++count) {
    for (std::size_t c = 0; c < width; ++c) all.push_back(table.finite_number(c));
  }
  set.rows = spread_rows(Eigen::Map<const RowMatrix>(all.data(), count, table.num_columns()),
                         std::min(most_rows, count));
  return set;
}

}  // namespace

RowMatrix spread_rows(const RowMatrix& rows, Index count) {
  RowMatrix picked(count, rows.cols());
  for (Index i = 0; i < count; ++i)
    picked.row(i) = rows.row(spread_position(i, count, rows.rows()));
  return picked;
}

SampleSet read_sample_set(const std::filesystem::path& path, const std::string& dataset,
                          Index most_rows) {
  if (!is_hdf5(path)) return read_csv(path, most_rows);
  return read_from_outside(
      path, [&](const h5::File& file) { return read_hdf5(file, dataset, most_rows); });
}

SampleSet in_order_of(const SampleSet& first, SampleSet second) {
  if (first.rows.cols() != second.rows.cols()) {
    throw InputError(fmt::format("{}: {} columns, must be {} as in {}", second.where,
                                 second.rows.cols(), first.rows.cols(), first.where));
  }
  if (first.columns.empty() || second.columns.empty()) return second;
  const std::vector<Index> order = match_columns(second.where, second.columns, first.columns);
  second.rows = second.rows(Eigen::all, order).eval();
  second.columns = first.columns;
  return second;
}

}  // namespace npdr::pipeline
