#include "pipeline/sources/precision.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "inference/feature_transform.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

constexpr Index kFewestFinite = 8;
constexpr double kSmallest = 1e-6, kRounding = 1e-12;  // shares of the mean

std::vector<Index> finite_rows(const RowMatrix& x) {
  std::vector<Index> rows;
  for (Index i = 0; i < x.rows(); ++i) {
    if (x.row(i).allFinite()) rows.push_back(i);
  }
  return rows;
}

}  // namespace

Findings find_lost_precision(const RowMatrix& x, const std::vector<Channel>& columns) {
  const std::vector<Index> rows = finite_rows(x);
  if (std::ssize(rows) < kFewestFinite) return {};
  std::vector<std::string> lost;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Eigen::ArrayXd values = x.col(static_cast<Index>(c))(rows);
    const double mean = values.mean();
    // Stable: squares of small deviations may be 0.
    const double deviation =
        (values - mean).matrix().stableNorm() / std::sqrt(static_cast<double>(values.size()));
    const double smallest =
        kSmallest * std::abs(mean) + inference::FeatureTransform::kLeastDeviation;
    const bool is_lost = deviation <= smallest && deviation > kRounding * std::abs(mean);
    if (!is_lost) continue;
    lost.push_back(fmt::format("'{}' by {:.2g} about {:.6g}", columns[c].label, deviation, mean));
  }
  if (lost.empty()) return {};
  return {warning(fmt::format(
      "single precision, in which rows are kept, can't tell apart what varies so little ({}): such "
      "columns are taken for constants, and say nothing of the parameters; subtract an offset from "
      "them or take another unit, in the simulator and in the observation",
      join(few_shortened(lost))))};
}

}  // namespace npdr::pipeline
