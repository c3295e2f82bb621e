/// Policy learning by Weighting Exploration with the Returns (PoWER).
///
/// Source: Kober and Peters 2011, "Policy search for motor primitives in robotics", Machine
/// Learning 84, with exploration of the parameters that is constant over a rollout:
/// the M-step of an expectation maximization whose lower bound weighs rollouts by their return.
/// With R_i clipped from below at min_return, B the num_importance_samples best policies of all
/// iterations (importance sampling as there: the best rollouts are used again, the others are
/// dropped), and the M candidates of the iteration, drawn around the old mean,
///   mean'  = sum_{i in B} R_i phi_i / sum_{i in B} R_i
///   Sigma' = sum_{i <= M} R_i (phi_i - mean)(phi_i - mean)^T / sum_{i <= M} R_i,
/// with standard deviations of at least min_std in every direction. The current policy, evaluated
/// along with the candidates, may enter B; it was not explored, so Sigma' leaves it out.
#pragma once

#include "inference/policy_search/policy_optimizer.h"

namespace npdr::inference {

class Power final : public PolicyOptimizer {
 public:
  Power(const PolicySearchConfig& config, PolicySearchState state);

 private:
  void update(const RowMatrix& policies, const Vector& returns, PolicySearchState& state) override;
};

}  // namespace npdr::inference
