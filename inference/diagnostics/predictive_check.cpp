#include "inference/diagnostics/predictive_check.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/quantile.h"
#include "inference/diagnostics/tail_probability.h"
#include "inference/diagnostics/uniformity.h"

namespace npdr::inference {

namespace {

// Predictions that differ from the observation by the rounding of single precision are ties.
Vector with_ties(Vector predicted, double observed) {
  for (double& value : predicted) {
    if (std::abs(value - observed) <=
        kFloatRounding * std::max(std::abs(value), std::abs(observed))) {
      value = observed;
    }
  }
  return predicted;
}

// How far each value lies from their median, over the distance of the quartile of its side, or over
// the mean distance where a quarter of the values and more are the median.
Vector excursions(const Vector& values) {
  Vector sorted = values;
  std::ranges::sort(sorted);
  const auto at = [&](double p) { return lower_quantile(sorted, p); };
  const double median = at(0.5);
  const Vector from_median = values.array() - median;
  const double usual = from_median.cwiseAbs().mean();
  if (usual == 0.0) return Vector::Zero(values.size());
  const double below = median - at(0.25), above = at(0.75) - median;
  return from_median.unaryExpr([&](double d) {
    const double quartile = d < 0.0 ? below : above;
    return std::abs(d) / (quartile > 0.0 ? quartile : usual);
  });
}

}  // namespace

PredictiveCheck check_prediction(const RowMatrix& summaries, const Vector& observed_summaries,
                                 const RowMatrixF& features, const VectorF& observed_features) {
  const Index count = summaries.cols();
  if (summaries.rows() != features.rows() || count != observed_summaries.size() || count < 1) {
    throw ShapeError("predictive check: summaries and features don't go together");
  }
  if (!summaries.allFinite() || !observed_summaries.allFinite()) {
    throw InputError("predictive check: summaries hold NaN or infinity, must be finite");
  }
  const Index n = summaries.rows();
  PredictiveCheck result;
  result.overall = test_out_of_distribution(usual_features(features), observed_features);
  result.summary_p_value.resize(count);
  Vector farthest = Vector::Zero(n + 1);  // of the predictions, and of the observation
  for (Index s = 0; s < count; ++s) {
    const Vector predicted = with_ties(summaries.col(s), observed_summaries(s));
    const double above = tail_probability(predicted, observed_summaries(s));
    const double below = tail_probability(-predicted, -observed_summaries(s));
    result.summary_p_value(s) = corrected(std::min(above, below), 2);
    Vector all(n + 1);
    all << predicted, observed_summaries(s);
    farthest = farthest.cwiseMax(excursions(all));
  }
  const double of_summaries = tail_probability(farthest.head(n), farthest(n));
  result.p_value = corrected(std::min(of_summaries, result.overall.p_value), 2);
  return result;
}

}  // namespace npdr::inference
