#include "pipeline/sources/repeated_outlier.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

constexpr Index kFewestRepeats = 2, kFewestOthers = 3;

}  // namespace

RepeatedOutliers::RepeatedOutliers(Index num_columns)
    : columns_(static_cast<std::size_t>(num_columns)) {}

void RepeatedOutliers::End::observe(float value) {
  if (num_outermost > 0 && value == outermost) {
    ++num_outermost;
  } else if (num_outermost == 0 || sign * value < sign * outermost) {
    next = outermost;
    num_others += num_outermost;
    outermost = value;
    num_outermost = 1;
  } else {
    if (num_others == 0 || sign * value < sign * next) next = value;
    ++num_others;
  }
}

// `innermost`: the number at the other end.
bool RepeatedOutliers::End::is_outlier(float innermost) const {
  if (num_outermost < kFewestRepeats || num_others < kFewestOthers) return false;
  const double nearest = next, range = std::abs(double{innermost} - nearest);
  return range > 0.0 && std::abs(nearest - double{outermost}) > range;
}

void RepeatedOutliers::observe(const Eigen::Ref<const RowMatrixF>& x) {
  if (x.cols() != std::ssize(columns_)) throw ShapeError("outliers: another number of columns");
  num_rows_ += x.rows();
  for (Index i = 0; i < x.rows(); ++i) {
    for (Index c = 0; c < x.cols(); ++c) {
      if (!std::isfinite(x(i, c))) continue;
      Ends& ends = columns_[static_cast<std::size_t>(c)];
      ends.smallest.observe(x(i, c));
      ends.largest.observe(x(i, c));
    }
  }
}

Findings RepeatedOutliers::find(const std::vector<Channel>& columns) const {
  if (columns.size() != columns_.size()) throw ShapeError("outliers: another number of names");
  std::vector<std::string> found;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto& [smallest, largest] = columns_[c];
    const End& end = smallest.is_outlier(largest.outermost) ? smallest : largest;
    const End& other = &end == &smallest ? largest : smallest;
    if (!end.is_outlier(other.outermost)) continue;
    found.push_back(fmt::format("'{}' is {:.6g} in {} of {} rows", columns[c].label, end.outermost,
                                end.num_outermost, num_rows_));
  }
  if (found.empty()) return {};
  return {warning(fmt::format(
      "{}, further from all other values than these lie apart: if that stands for a failure, "
      "write NaN, or posteriors are those of a simulator that gives it",
      join(few_shortened(found))))};
}

}  // namespace npdr::pipeline
