#include "pipeline/artefacts/feature_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/h5.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

// The columns of a file, and where those stand that are wanted.
struct FeatureColumns {
  std::vector<Channel> features;
  std::vector<Index> columns;
};

FeatureColumns columns_of(const std::string& where, Index num_columns,
                          const std::vector<Channel>& named, const FeatureDemands& wanted) {
  const std::vector<Channel>& expected = wanted.features;
  if (wanted.names_from == NamesFrom::observation && named.empty() && expected.size() > 1) {
    throw InputError(fmt::format(
        "{}: its columns have no names, must be named {}, as those of x_o, in any order; or say "
        "their order with simulator.features",
        where, join(few_shortened(feature_names(expected)))));
  }
  if (!named.empty() && !expected.empty()) return {expected, match_columns(where, named, expected)};
  FeatureColumns found{expected, {}};
  if (expected.empty()) found.features = named.empty() ? numbered_features(num_columns) : named;
  if (num_columns != static_cast<Index>(found.features.size())) {
    throw InputError(fmt::format("{}: has {}, must have {}: {}", where,
                                 counted(num_columns, "column"), found.features.size(),
                                 join(feature_names(found.features))));
  }
  found.columns = all_columns(num_columns);
  return found;
}

FeatureRows read_csv(const std::filesystem::path& path, Index num_rows,
                     const FeatureDemands& demands) {
  NumberTable table(path);
  const FeatureColumns found =
      columns_of(table.name(), table.num_columns(), table.columns(), demands);
  FeatureRows rows{found.features, RowMatrix(num_rows, table.num_columns())};
  std::vector<double> row(static_cast<std::size_t>(table.num_columns()));
  Index count = 0;
  for (; table.next(row); ++count) {
    if (count == num_rows) {
      throw InputError(fmt::format("{}: has more than {}, must have {}", table.name(),
                                   counted(num_rows, "row"), num_rows));
    }
    for (Index c = 0; c < rows.x.cols(); ++c) rows.x(count, c) = row[static_cast<std::size_t>(c)];
  }
  if (count < num_rows) {
    throw InputError(
        fmt::format("{}: has {}, must have {}", table.name(), counted(count, "row"), num_rows));
  }
  // The rest of a number that lacks digits is another number.
  if (demands.needs_line_ends && !table.has_line_end()) {
    throw InputError(table.name() +
                     ": its last line has no end, as if the file were cut; end each line");
  }
  rows.x = RowMatrix(rows.x(Eigen::all, found.columns));
  return rows;
}

FeatureRows read_hdf5(const h5::File& file, Index num_rows, const FeatureDemands& demands) {
  const h5::Dataset x = own_dataset(file, "x");
  const bool is_vector = x.shape().size() == 1 && num_rows == 1;
  const Index width = is_vector ? x.num_rows() : x.row_size();
  if (!is_vector) x.require_shape({num_rows, -1});
  if (width < 1) throw InputError(x.where() + " is empty");
  x.require_readable(h5::ElementType::f64);
  const std::vector<Channel> named = column_channels(x, width);
  const FeatureColumns found = columns_of(x.where(), width, named, demands);
  FeatureRows rows{found.features, RowMatrix(num_rows, width)};
  x.read_rows<double>(0, x.num_rows(), {rows.x.data(), static_cast<std::size_t>(rows.x.size())});
  rows.x = RowMatrix(rows.x(Eigen::all, found.columns));
  return rows;
}

}  // namespace

FeatureRows read_features(const std::filesystem::path& path, FileFormat format, Index num_rows,
                          const FeatureDemands& demands) {
  if (format == FileFormat::csv) return read_csv(path, num_rows, demands);
  return read_from_outside(
      path, [&](const h5::File& file) { return read_hdf5(file, num_rows, demands); });
}

Target observation_target(const std::vector<Channel>& features, const Vector& x_o,
                          const std::string& source) {
  const auto width = static_cast<Index>(features.size());
  Target target;
  target.dt = 1.0;
  target.state_channels = features;
  target.source = source;
  Rollout rollout{"x_o", RowMatrix::Zero(2, width), RowMatrix(1, 0)};
  rollout.states.row(1) = x_o.transpose();
  target.rollouts.push_back(std::move(rollout));
  return target;
}

Target read_observation(const std::filesystem::path& path, const std::vector<Channel>& expected) {
  const FileFormat format = path.extension() == ".csv" ? FileFormat::csv : FileFormat::hdf5;
  const FeatureRows rows = read_features(path, format, 1, {.features = expected});
  Target target =
      observation_target(rows.features, rows.x.row(0).transpose(), path.filename().string());
  for (Index f = 0; f < rows.x.cols(); ++f) {
    // As a float32, too: that is what it becomes.
    if (std::isfinite(static_cast<float>(rows.x(0, f)))) continue;
    throw InputError(
        fmt::format("{}: '{}' = {}, must be a number up to {:g}: leave out what "
                    "wasn't measured, here and of what is simulated",
                    path.string(), rows.features[static_cast<std::size_t>(f)].label, rows.x(0, f),
                    std::numeric_limits<float>::max()));
  }
  return target;
}

Findings warnings_of_observation(const std::filesystem::path& path) {
  if (path.extension() != ".csv") return {};
  NumberTable table(path);
  while (table.next()) continue;
  if (table.has_line_end()) return {};
  return {warning_of_end(table.name())};
}

}  // namespace npdr::pipeline
