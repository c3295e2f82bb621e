#include "analysis/feature_comparison.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "analysis/quantiles.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

void require_width(Index found, Index expected) {
  if (found == expected) return;
  throw ShapeError(std::to_string(found) + " features, must be " + std::to_string(expected));
}

}  // namespace

FeatureSpread::FeatureSpread(Index num_features)
    : mean_(Vector::Zero(num_features)), sum_of_squares_(Vector::Zero(num_features)) {}

void FeatureSpread::add(std::span<const float> x) {
  require_width(static_cast<Index>(x.size()), mean_.size());
  ++count_;
  for (Index f = 0; f < mean_.size(); ++f) {
    const auto value = static_cast<double>(x[static_cast<std::size_t>(f)]);
    const double before = value - mean_(f);
    mean_(f) += before / static_cast<double>(count_);
    sum_of_squares_(f) += before * (value - mean_(f));
  }
}

Vector FeatureSpread::deviation() const {
  if (count_ < 2) return Vector::Zero(mean_.size());
  return (sum_of_squares_ / static_cast<double>(count_ - 1)).cwiseSqrt();
}

Vector feature_distance(const Eigen::Ref<const RowMatrixF>& x, const Vector& x_o,
                        const Vector& deviation) {
  require_width(x.cols(), x_o.size());
  require_width(deviation.size(), x_o.size());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto num_varying = static_cast<double>((deviation.array() > 0.0).count());
  Vector distance(x.rows());
  for (Index i = 0; i < x.rows(); ++i) {
    double sum = num_varying > 0.0 ? 0.0 : nan;
    for (Index f = 0; f < x.cols(); ++f) {
      const auto value = static_cast<double>(x(i, f));
      if (!std::isfinite(value)) sum = nan;
      if (!(deviation(f) > 0.0)) continue;
      const double difference = (value - x_o(f)) / deviation(f);
      sum += difference * difference;
    }
    distance(i) = std::sqrt(sum / num_varying);
  }
  return distance;
}

FeaturePrediction predict_feature(const Eigen::Ref<const Vector>& values, double x_o) {
  FeaturePrediction prediction{summarize(values), {}, 0.0};
  std::vector<double> sorted;
  std::copy_if(values.begin(), values.end(), std::back_inserter(sorted),
               [](double v) { return std::isfinite(v); });
  std::ranges::sort(sorted);
  constexpr double probabilities[] = {0.05, 0.5, 0.95};
  for (std::size_t q = 0; q < 3; ++q) {
    prediction.quantiles[q] = quantile_of_sorted(sorted, probabilities[q]);
  }
  const auto ties = std::equal_range(sorted.begin(), sorted.end(), x_o);
  const auto below = static_cast<double>(ties.first - sorted.begin());
  const auto equal = static_cast<double>(ties.second - ties.first);
  prediction.tail = (below + 0.5 * equal) / static_cast<double>(sorted.size());
  return prediction;
}

}  // namespace npdr::analysis
