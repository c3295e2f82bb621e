#include "inference/policy_search/cross_entropy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "inference/policy_search/best_rows.h"
#include "inference/policy_search/exploration.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr Index kMinElites = 2;
constexpr Index kNumBest = 1;  // to know the best policy; the update doesn't use it

Index num_elites(const PolicySearchConfig& config) {
  const double share = config.elite_fraction * static_cast<double>(config.population);
  return std::max(static_cast<Index>(std::lround(share)), kMinElites);
}

}  // namespace

CrossEntropy::CrossEntropy(const PolicySearchConfig& config, PolicySearchState state)
    : PolicyOptimizer(config, std::move(state), kNumBest) {
  if (config.population < kMinElites) {
    throw InputError(fmt::format("policy.population = {}, must be >= {} with 'cross_entropy'",
                                 config.population, kMinElites));
  }
}

void CrossEntropy::update(const RowMatrix& policies, const Vector& returns,
                          PolicySearchState& state) {
  const Index explored = policies.rows() - 1;
  const RowMatrix elites = policies.bottomRows(explored)(
      best_rows(returns.tail(explored), num_elites(config())), Eigen::all);
  const Vector equal = Vector::Ones(elites.rows());
  const Vector mean = weighted_mean(elites, equal);
  const double s = config().smoothing;
  state.covariance = with_min_std(
      s * scatter_around(mean, elites, equal) + (1.0 - s) * state.covariance, config().min_std);
  state.mean = s * mean + (1.0 - s) * state.mean;
}

}  // namespace npdr::inference
