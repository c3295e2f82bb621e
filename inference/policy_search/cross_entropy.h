/// The cross-entropy method.
///
/// Source: Rubinstein 1999; de Boer, Kroese, Mannor and Rubinstein 2005, "A tutorial on the
/// cross-entropy method", continuous optimization with smoothed updates; for policies Mannor,
/// Rubinstein and Gat 2003. With E the elites, the elite_fraction best of the M candidates of an
/// iteration (rounded, at least two), and smoothing s,
///   m = mean of phi_i over E,   C = mean of (phi_i - m)(phi_i - m)^T over E,
///   mean' = s m + (1 - s) mean,   Sigma' = s C + (1 - s) Sigma,
/// with standard deviations of at least min_std in every direction. The current policy, evaluated
/// along with the candidates, is no elite: the fit is to draws of the Gaussian.
#pragma once

#include "inference/policy_search/policy_optimizer.h"

namespace npdr::inference {

class CrossEntropy final : public PolicyOptimizer {
 public:
  /// Throws InputError for a population of fewer than two.
  CrossEntropy(const PolicySearchConfig& config, PolicySearchState state);

 private:
  void update(const RowMatrix& policies, const Vector& returns, PolicySearchState& state) override;
};

}  // namespace npdr::inference
