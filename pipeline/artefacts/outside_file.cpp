#include "pipeline/artefacts/outside_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <numeric>

#include "core/shell_text.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostAtOnce = 4096;  // rows that are read together
// How far apart rows may lie that are read at once: what lies between is faster read than skipped.
constexpr Index kNear = 16;

// HDF5's signature may also stand further on, behind a user's block; ours and h5py's have none.
bool is_hdf5(const std::filesystem::path& path) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) return false;  // a pipe has no begin
  std::array<char, 4> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  return begin == std::array<char, 4>{'\x89', 'H', 'D', 'F'};
}

// A posterior has no samples, but gives some.
void require_samples(const h5::File& file) {
  if (!file.has_attribute("schema")) return;
  if (file.attribute<std::string>("schema") != kPosteriorSchema.name) return;
  const std::string path = file.where();
  throw InputError(
      fmt::format("{}: is a posterior, must be samples: npdr sample {} -n 10000 > samples.csv, or "
                  "evaluate.h5 of the same method and seed",
                  path, shell_word(path)));
}

SampleSet read_hdf5(const h5::File& file, const std::string& name, Index most_rows,
                    const StreamId& id) {
  require_samples(file);
  const h5::Dataset dataset = file.dataset(name);
  dataset.require_shape({-1, -1});
  dataset.require_readable(h5::ElementType::f64);
  SampleSet set{dataset.where(), column_channels(dataset, dataset.row_size()), {}};
  const std::vector<Index> rows = spread_positions(most_rows, dataset.num_rows(), id);
  set.rows = read_rows_at(dataset, rows, all_columns(dataset.row_size()));
  const std::span<const double> all(set.rows.data(), static_cast<std::size_t>(set.rows.size()));
  dataset.require_finite<double>(all);
  return set;
}

Index count_rows(const std::filesystem::path& path) {
  NumberTable table(path);
  Index count = 0;
  while (table.next()) ++count;
  return count;
}

// Twice, so that memory doesn't grow with the file.
SampleSet read_csv(const std::filesystem::path& path, Index most_rows, const StreamId& id) {
  const std::vector<Index> rows = spread_positions(most_rows, count_rows(path), id);
  NumberTable table(path);
  SampleSet set{table.name(), table.columns(), {}};
  set.rows.resize(std::ssize(rows), table.num_columns());
  Index at = 0;
  for (Index row = 0; at < std::ssize(rows) && table.next(); ++row) {
    if (row != rows[static_cast<std::size_t>(at)]) continue;
    for (Index c = 0; c < set.rows.cols(); ++c) {
      set.rows(at, c) = table.finite_number(static_cast<std::size_t>(c));
    }
    ++at;
  }
  set.rows.conservativeResize(at, Eigen::NoChange);  // should the file be shorter by now
  return set;
}

}  // namespace

h5::Dataset own_dataset(const h5::Group& group, const std::string& name) {
  h5::Dataset dataset = group.dataset(name);
  if (dataset.part_files().empty()) return dataset;
  throw InputError(dataset.where() + ": its rows lie in other files, must be in this one");
}

std::vector<Index> all_columns(Index count) {
  std::vector<Index> columns(static_cast<std::size_t>(count));
  std::iota(columns.begin(), columns.end(), Index{0});
  return columns;
}

RowMatrix read_rows_at(const h5::Dataset& dataset, std::span<const Index> rows,
                       const std::vector<Index>& columns) {
  RowMatrix picked(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  std::vector<std::size_t> ascending(rows.size());
  std::iota(ascending.begin(), ascending.end(), std::size_t{0});
  std::ranges::sort(ascending, {}, [&](std::size_t i) { return rows[i]; });
  const auto at = [&](std::size_t k) { return rows[ascending[k]]; };
  RowMatrix block;
  for (std::size_t k = 0, end = 0; k < rows.size();) {
    const Index begin = at(k);
    for (end = k + 1; end < rows.size(); ++end) {
      if (at(end) - at(end - 1) > kNear || at(end) - begin >= kMostAtOnce) break;
    }
    block.resize(at(end - 1) + 1 - begin, dataset.row_size());
    dataset.read_rows<double>(begin, block.rows(),
                              {block.data(), static_cast<std::size_t>(block.size())});
    for (; k < end; ++k) {
      picked.row(static_cast<Index>(ascending[k])) = block(at(k) - begin, columns);
    }
  }
  return picked;
}

std::vector<Index> spread_positions(Index most, Index num_rows, const StreamId& id) {
  const Index count = std::min(most, num_rows);
  // Files may claim so many that i num_rows would overflow.
  const auto begin = [&](Index i) {
    return i * (num_rows / count) + i * (num_rows % count) / count;
  };
  Stream stream(id);
  std::vector<Index> positions;
  for (Index i = 0; i < count; ++i) {
    const auto length = static_cast<double>(begin(i + 1) - begin(i));
    positions.push_back(begin(i) + static_cast<Index>(length * stream.uniform()));
  }
  return positions;
}

SampleSet read_sample_set(const std::filesystem::path& path, const std::string& dataset,
                          Index most_rows, const StreamId& id) {
  if (!is_hdf5(path)) {
    if (path.extension() != ".toml") return read_csv(path, most_rows, id);
    throw InputError(
        fmt::format("{}: is a study, must be samples, CSV or HDF5; draw some of its "
                    "posterior: npdr sample {} -n 10000 > samples.csv",
                    path.string(), shell_word(path.string())));
  }
  return read_from_outside(
      path, [&](const h5::File& file) { return read_hdf5(file, dataset, most_rows, id); });
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
