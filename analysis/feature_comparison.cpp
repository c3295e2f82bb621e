#include "analysis/feature_comparison.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "core/quantile.h"

namespace npdr::analysis {

FeaturePrediction predict_feature(const Eigen::Ref<const Vector>& values, double x_o) {
  FeaturePrediction prediction{summarize(values), {}, 0.0};
  const std::vector<double> sorted = sorted_finite(values);
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
