#include "pipeline/artefacts/dataset_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/feature_names.h"
#include "core/text.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

constexpr Index kBlock = 4096;  // rows that are written at once

// `num_rows`: -1 for any number, 1 or more.
void require_table(const h5::Dataset& dataset, Index num_rows) {
  dataset.require_shape({num_rows, -1});
  if (dataset.num_rows() < 1 || dataset.row_size() < 1) {
    throw InputError(dataset.where() + " is empty");
  }
  dataset.require_readable(h5::ElementType::f64);
  const std::vector<Index> first = {0};
  read_rows_at(dataset, first, {});
}

// With the names that theta must have.
std::vector<Channel> all_parameters(const h5::Dataset& theta) {
  std::vector<Channel> named = column_channels(theta, theta.row_size());
  if (named.empty()) {
    throw InputError(theta.where() +
                     " has no attribute 'labels', must have one text per column: the names of the "
                     "parameters");
  }
  for (Channel& parameter : named) {
    if (parameter.unit.empty()) parameter.unit = "1";
  }
  return named;
}

// The rows of a file, after they have been read to the end.
Index count_rows(const std::filesystem::path& path, const CsvFormat& format) {
  NumberTable table(path, Header::optional, format);
  std::vector<double> row(static_cast<std::size_t>(table.num_columns()));
  Index count = 0;
  while (table.next(row)) ++count;
  if (count == 0) throw InputError(path.string() + ": has a header, but no rows");
  return count;
}

void describe(h5::Dataset& dataset, const std::vector<Channel>& columns, const std::string& what) {
  describe_columns(dataset, columns);
  dataset.label_dimensions({"row", what});
}

void check_finite(const NumberTable& table, Index row, std::span<const double> values) {
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (std::isfinite(values[c])) continue;
    throw InputError(
        fmt::format("{}: '{}' of row {} = {}, must be finite; leave out this row in "
                    "both files",
                    table.name(), table.columns()[c].label, row + 1, values[c]));
  }
}

// Copies all rows of a table; `inspect(row, values)` sees each of them.
template <class Inspect>
void copy_table(NumberTable& table, h5::Dataset& dataset, const Inspect& inspect) {
  RowMatrix block(kBlock, table.num_columns());
  const auto width = static_cast<std::size_t>(table.num_columns());
  Index written = 0, filled = 0;
  const auto flush = [&] {
    dataset.write_rows<double>(written, filled,
                               {block.data(), static_cast<std::size_t>(filled) * width});
    written += filled;
    filled = 0;
  };
  while (written + filled < dataset.num_rows() && table.next({block.row(filled).data(), width})) {
    inspect(written + filled, std::span<const double>(block.row(filled).data(), width));
    if (++filled == kBlock) flush();
  }
  if (filled > 0) flush();
}

}  // namespace

DatasetFile::DatasetFile(const std::filesystem::path& path,
                         const std::vector<std::string>& parameters,
                         const std::vector<Channel>& features)
    : DatasetFile(read_from_outside(path, [&](h5::File file) {
        return DatasetFile(std::move(file), parameters, features);
      })) {}

DatasetFile::DatasetFile(h5::File file, const std::vector<std::string>& parameters,
                         const std::vector<Channel>& features)
    : file_(std::move(file)), theta_(file_.dataset("theta")), x_(file_.dataset("x")) {
  require_table(theta_, -1);
  require_table(x_, theta_.num_rows());
  const std::vector<Channel> present = all_parameters(theta_);
  std::vector<Channel> wanted;
  for (const std::string& name : parameters) wanted.push_back({name, "1"});
  theta_columns_ = wanted.empty() ? all_columns(std::ssize(present))
                                  : find_columns(theta_.where(), present, wanted);
  for (const Index column : theta_columns_) {
    parameters_.push_back(present[static_cast<std::size_t>(column)]);
  }
  features_ = column_channels(x_, x_.row_size());
  if (features_.empty()) features_ = numbered_features(x_.row_size());
  x_columns_ = all_columns(x_.row_size());
  if (features.empty()) return;
  if (x_.has_attribute("labels")) {
    x_columns_ = match_columns(x_.where(), features_, features);
  } else if (features.size() != features_.size()) {
    throw InputError(fmt::format("{} has {}, must have {}: {}", x_.where(),
                                 counted(std::ssize(features_), "column"), features.size(),
                                 join(feature_names(features))));
  }
  features_ = features;
}

RowMatrix DatasetFile::theta(std::span<const Index> rows) const {
  RowMatrix values = read_rows_at(theta_, rows, theta_columns_);
  for (Index i = 0; i < values.rows(); ++i) {
    for (Index d = 0; d < values.cols(); ++d) {
      if (std::isfinite(values(i, d))) continue;
      throw InputError(fmt::format("{} holds {} at ({}, {}), must be finite", theta_.where(),
                                   values(i, d), rows[static_cast<std::size_t>(i)],
                                   theta_columns_[static_cast<std::size_t>(d)]));
    }
  }
  return values;
}

RowMatrix DatasetFile::x(std::span<const Index> rows) const {
  return read_rows_at(x_, rows, x_columns_);
}

DatasetCounts import_dataset(const std::filesystem::path& theta, const std::filesystem::path& x,
                             const std::filesystem::path& output, const CsvFormat& format) {
  DatasetCounts counts;
  counts.num_rows = count_rows(theta, format);
  if (const Index others = count_rows(x, format); others != counts.num_rows) {
    throw InputError(fmt::format("{}: has {}, must have {} like {}", x.string(),
                                 counted(others, "row"), counts.num_rows, theta.string()));
  }
  NumberTable theta_table(theta, Header::optional, format);
  NumberTable x_table(x, Header::optional, format);
  if (!theta_table.has_header()) {
    throw InputError(theta.string() + ":1: must name the parameters, such as mass,length");
  }
  counts.parameters = theta_table.columns();
  counts.features =
      x_table.has_header() ? x_table.columns() : numbered_features(x_table.num_columns());

  AtomicFile atomic(output);
  h5::File file = h5::File::create(atomic.temporary(), output.string());
  h5::Dataset theta_rows = file.create_dataset("theta", h5::ElementType::f64,
                                               {counts.num_rows, theta_table.num_columns()});
  describe(theta_rows, counts.parameters, "parameter");
  copy_table(theta_table, theta_rows, [&](Index row, std::span<const double> values) {
    check_finite(theta_table, row, values);
  });
  h5::Dataset x_rows =
      file.create_dataset("x", h5::ElementType::f64, {counts.num_rows, x_table.num_columns()});
  describe(x_rows, counts.features, "feature");
  copy_table(x_table, x_rows, [&](Index, std::span<const double> values) {
    counts.num_failed += !std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  });
  file.close();
  atomic.commit();
  for (const NumberTable* table : {&theta_table, &x_table}) {
    if (!table->has_line_end()) counts.unended.push_back(table->name());
  }
  return counts;
}

}  // namespace npdr::pipeline
