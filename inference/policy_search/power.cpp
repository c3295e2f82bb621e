#include "inference/policy_search/power.h"

#include <utility>

#include "inference/policy_search/exploration.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

Power::Power(const PolicySearchConfig& config, PolicySearchState state)
    : PolicyOptimizer(config, std::move(state), config.num_importance_samples) {}

void Power::update(const RowMatrix& policies, const Vector& returns, PolicySearchState& state) {
  const Index explored = policies.rows() - 1;
  const Vector weights = returns.tail(explored).cwiseMax(config().min_return);
  state.covariance = with_min_std(
      scatter_around(state.mean, policies.bottomRows(explored), weights), config().min_std);
  state.mean = weighted_mean(state.best_policies, state.best_returns.cwiseMax(config().min_return));
}

}  // namespace npdr::inference
