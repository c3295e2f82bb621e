#include "pipeline/artefacts/sample_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <span>

#include "core/error.h"
#include "core/shell_text.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/artefacts/schemas.h"
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

// Which of `num_rows` rows a sample set has.
struct Wanted {
  Index most_rows = 0;
  StreamId id;

  std::vector<Index> of(Index num_rows) const {
    return spread_positions(std::min(most_rows, num_rows), num_rows, id);
  }
};

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

SampleSet read_hdf5(const h5::File& file, const std::string& name, const Wanted& wanted) {
  require_samples(file);
  const h5::Dataset dataset = file.dataset(name);
  dataset.require_shape({-1, -1});
  dataset.require_readable(h5::ElementType::f64);
  SampleSet set{dataset.where(), column_channels(dataset, dataset.row_size()), {}};
  const std::vector<Index> rows = wanted.of(dataset.num_rows());
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
SampleSet read_csv(const std::filesystem::path& path, const Wanted& wanted) {
  const std::vector<Index> rows = wanted.of(count_rows(path));
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

std::vector<Index> spread_positions(Index count, Index num_rows, const StreamId& id) {
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
  const Wanted wanted{most_rows, id};
  if (!is_hdf5(path)) {
    if (path.extension() != ".toml") return read_csv(path, wanted);
    throw InputError(
        fmt::format("{}: is a study, must be samples, CSV or HDF5; draw some of its "
                    "posterior: npdr sample {} -n 10000 > samples.csv",
                    path.string(), shell_word(path.string())));
  }
  return read_from_outside(path,
                           [&](const h5::File& file) { return read_hdf5(file, dataset, wanted); });
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
