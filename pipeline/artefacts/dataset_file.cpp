#include "pipeline/artefacts/dataset_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/feature_names.h"
#include "core/text.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

constexpr Index kBlock = 4096;  // rows that are read or written at once

// With the names that theta must have.
std::vector<Channel> all_parameters(const h5::Dataset& theta) {
  theta.require_shape({-1, -1});
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

// Those that are wanted, in this order; all where none is.
std::vector<Index> theta_columns(const h5::Dataset& theta, const std::vector<Channel>& present,
                                 const std::vector<std::string>& wanted) {
  std::vector<Index> columns;
  if (wanted.empty()) {
    columns.resize(present.size());
    std::iota(columns.begin(), columns.end(), Index{0});
  }
  for (const std::string& name : wanted) {
    const auto column = std::ranges::find(present, name, &Channel::label);
    if (column == present.end()) {
      std::vector<std::string> labels;
      for (const Channel& parameter : present) labels.push_back(parameter.label);
      throw InputError(theta.where() + ": " +
                       missing_name("parameter", name, few_shortened(labels)));
    }
    columns.push_back(column - present.begin());
  }
  return columns;
}

std::vector<Channel> all_features(const h5::Dataset& x) {
  x.require_shape({-1, -1});
  const std::vector<Channel> named = column_channels(x, x.row_size());
  return named.empty() ? numbered_features(x.row_size()) : named;
}

void check(const h5::File& file) {
  const h5::Dataset theta = file.dataset("theta");
  const h5::Dataset x = file.dataset("x");
  theta.require_shape({-1, -1});
  if (theta.num_rows() < 1 || theta.row_size() < 1) throw InputError(theta.where() + " is empty");
  x.require_shape({theta.num_rows(), -1});
  if (x.row_size() < 1) throw InputError(x.where() + " is empty");
  theta.require_readable(h5::ElementType::f64);
  x.require_readable(h5::ElementType::f64);
  std::vector<double> row(static_cast<std::size_t>(std::max(theta.row_size(), x.row_size())));
  theta.read_rows<double>(0, 1, std::span(row).first(static_cast<std::size_t>(theta.row_size())));
  x.read_rows<double>(0, 1, std::span(row).first(static_cast<std::size_t>(x.row_size())));
  all_parameters(theta);
  all_features(x);
}

h5::File open_checked(const std::filesystem::path& path) {
  read_from_outside(path, check);
  return h5::File::open(path);
}

// How far apart rows may lie that are read at once: what lies between is faster read than skipped.
constexpr Index kNear = 16;

// Rows of a file by their positions in it, in another order of theirs.
struct RowOrder {
  std::span<const Index> rows;
  std::vector<std::size_t> ascending;  // of them

  explicit RowOrder(std::span<const Index> given) : rows(given), ascending(given.size()) {
    std::iota(ascending.begin(), ascending.end(), std::size_t{0});
    std::ranges::sort(ascending, {}, [&](std::size_t i) { return rows[i]; });
  }
  Index at(std::size_t k) const { return rows[ascending[k]]; }
  // One past those from the `begin`th on that are read at once.
  std::size_t end_of_block(std::size_t begin) const {
    std::size_t end = begin + 1;
    while (end < ascending.size() && at(end) - at(end - 1) <= kNear && at(end) - at(begin) < kBlock)
      ++end;
    return end;
  }
};

// Some columns of rows at some positions.
RowMatrix read_at(const h5::Dataset& dataset, std::span<const Index> rows,
                  const std::vector<Index>& columns) {
  RowMatrix picked(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  const RowOrder order(rows);
  RowMatrix block;
  for (std::size_t k = 0; k < rows.size();) {
    const std::size_t end = order.end_of_block(k);
    const Index begin = order.at(k), count = order.at(end - 1) + 1 - begin;
    block.resize(count, dataset.row_size());
    dataset.read_rows<double>(begin, count, {block.data(), static_cast<std::size_t>(block.size())});
    for (; k < end; ++k) {
      picked.row(static_cast<Index>(order.ascending[k])) = block(order.at(k) - begin, columns);
    }
  }
  return picked;
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
    : file_(open_checked(path)),
      theta_(file_.dataset("theta")),
      x_(file_.dataset("x")),
      features_(all_features(x_)) {
  const std::vector<Channel> present = all_parameters(theta_);
  theta_columns_ = theta_columns(theta_, present, parameters);
  for (const Index column : theta_columns_) {
    parameters_.push_back(present[static_cast<std::size_t>(column)]);
  }
  x_columns_.resize(features_.size());
  std::iota(x_columns_.begin(), x_columns_.end(), Index{0});
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
  RowMatrix values = read_at(theta_, rows, theta_columns_);
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
  return read_at(x_, rows, x_columns_);
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
