#include "inference/diagnostics/predictive_check.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "inference/diagnostics/tail_probability.h"
#include "inference/diagnostics/uniformity.h"

namespace npdr::inference {

namespace {

// Predictions that differ from the observation by the rounding of single precision are ties.
Vector with_ties(Vector predicted, double observed) {
  constexpr double rounding = 1e-6;
  for (double& value : predicted) {
    if (std::abs(value - observed) <= rounding * std::max(std::abs(value), std::abs(observed))) {
      value = observed;
    }
  }
  return predicted;
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
  PredictiveCheck result;
  result.overall = test_out_of_distribution(features, observed_features);
  result.summary_p_value.resize(count);
  for (Index s = 0; s < count; ++s) {
    const Vector predicted = with_ties(summaries.col(s), observed_summaries(s));
    const double above = tail_probability(predicted, observed_summaries(s));
    const double below = tail_probability(-predicted, -observed_summaries(s));
    result.summary_p_value(s) = corrected(std::min(above, below), 2);
  }
  const double of_summaries = corrected(result.summary_p_value.minCoeff(), count);
  result.p_value = corrected(std::min(of_summaries, result.overall.p_value), 2);
  return result;
}

}  // namespace npdr::inference
