/// Posterior predictive check: does what posterior samples predict look like what was observed?
///
/// Source: Gelman, Meng and Stern 1996, "Posterior predictive assessment of model fitness via
/// realized discrepancies". A p-value that is small says that the observation is unusual among the
/// predictions. As the posterior has seen the observation, such p-values are near 1/2 more often
/// than uniform ones: the false-alarm rate is at most what they say.
///
/// Of all summaries there is one test, whatever their number: how far prediction i is from the
/// usual,
///   max_s |s_is - median_s| / (distance of the median from the quartile on that side),
/// with medians and quartiles of predictions and observation together, so that the observation is
/// one of n + 1 alike where the model holds (Westfall and Young 1993). Each summary's own p-value,
/// in a tail that few of the n reach, would be too rough to be multiplied by their number.
#pragma once

#include "inference/diagnostics/out_of_distribution.h"

namespace npdr::inference {

/// Tests of S summaries one by one, and of all features at once.
struct PredictiveCheck {
  /// (S) two-sided: 2 min(P(s <= s_o), P(s >= s_o)), at most 1; equal but for rounding is equal.
  Vector summary_p_value;
  OutOfDistribution overall;  ///< of all features at once
  double p_value = 1.0;       ///< twice the smaller of the two: of the farthest of S, and overall
};

/// Predictions: summaries (n, S) and features (n, F); observed: (S) and (F). Throws ShapeError when
/// shapes don't go together and InputError for fewer than kFewestSimulations rows, or what isn't
/// finite.
PredictiveCheck check_prediction(const RowMatrix& summaries, const Vector& observed_summaries,
                                 const RowMatrixF& features, const VectorF& observed_features);

}  // namespace npdr::inference
