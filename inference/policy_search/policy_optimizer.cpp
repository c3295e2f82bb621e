#include "inference/policy_search/policy_optimizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "inference/policy_search/best_rows.h"
#include "inference/policy_search/cross_entropy.h"
#include "inference/policy_search/exploration.h"
#include "inference/policy_search/power.h"

namespace npdr::inference {
namespace {

using OptimizerPtr = std::unique_ptr<PolicyOptimizer>;

template <typename Value>
void require(bool ok, const char* field, const Value& found, const std::string& allowed) {
  if (ok) return;
  throw InputError(fmt::format("policy.{} = {}, must be {}", field, found, allowed));
}

void check_state(const PolicySearchState& state, Index num_best) {
  const Index q = state.mean.size();
  const bool ok = q > 0 && state.iteration >= 0 && state.covariance.rows() == q &&
                  state.covariance.cols() == q && state.best_policies.cols() == q &&
                  state.best_policies.rows() == state.best_returns.size() &&
                  state.best_returns.size() <= num_best;
  if (ok) return;
  throw ShapeError(fmt::format(
      "policy search: a state with a mean of {} parameters, a covariance of {} x {}, {} x {} best "
      "policies and {} best returns doesn't go together (at most {} are kept)",
      q, state.covariance.rows(), state.covariance.cols(), state.best_policies.rows(),
      state.best_policies.cols(), state.best_returns.size(), num_best));
}

}  // namespace

void check(const PolicySearchConfig& config) {
  const auto& c = config;
  require(c.population >= 1, "population", c.population, ">= 1");
  require(c.num_iterations >= 1, "num_iterations", c.num_iterations, ">= 1");
  require(c.initial_std > 0.0, "initial_std", c.initial_std, "> 0");
  require(c.min_std > 0.0 && c.min_std <= c.initial_std, "min_std", c.min_std,
          fmt::format("> 0 and <= initial_std = {}", c.initial_std));
  require(c.num_importance_samples >= 1, "num_importance_samples", c.num_importance_samples,
          ">= 1");
  require(c.min_return > 0.0, "min_return", c.min_return, "> 0");
  require(c.elite_fraction > 0.0 && c.elite_fraction <= 1.0, "elite_fraction", c.elite_fraction,
          "in (0, 1]");
  require(c.smoothing > 0.0 && c.smoothing <= 1.0, "smoothing", c.smoothing, "in (0, 1]");
}

PolicyOptimizer::PolicyOptimizer(const PolicySearchConfig& config, PolicySearchState state,
                                 Index num_best)
    : config_(config), state_(std::move(state)), num_best_(num_best) {
  check(config_);
  check_state(state_, num_best_);
}

RowMatrix PolicyOptimizer::ask(const StreamId& id) const {
  StreamId iteration = named(id, "policy_candidates");
  iteration.epoch = static_cast<std::uint64_t>(state_.iteration);
  RowMatrix policies(1 + config_.population, state_.mean.size());
  policies.row(0) = state_.mean.transpose();
  policies.bottomRows(config_.population) =
      draw_gaussian(state_.mean, state_.covariance, config_.population, iteration);
  return policies;
}

void PolicyOptimizer::tell(const RowMatrix& policies, const Vector& returns) {
  if (policies.rows() != 1 + config_.population || policies.cols() != state_.mean.size() ||
      returns.size() != policies.rows()) {
    throw ShapeError(
        fmt::format("policy search: {} x {} policies and {} returns, must be {} x {} and {}",
                    policies.rows(), policies.cols(), returns.size(), 1 + config_.population,
                    state_.mean.size(), 1 + config_.population));
  }
  if (!returns.allFinite()) {
    throw InputError(
        fmt::format("policy search, iteration {}: a return isn't finite", state_.iteration + 1));
  }
  remember_best(policies, returns);
  update(policies, returns, state_);
  ++state_.iteration;
}

// The older of equal returns stays.
void PolicyOptimizer::remember_best(const RowMatrix& policies, const Vector& returns) {
  const Index known = state_.best_returns.size();
  RowMatrix all(known + policies.rows(), policies.cols());
  all << state_.best_policies, policies;
  Vector values(all.rows());
  values << state_.best_returns, returns;
  const std::vector<Index> order = best_rows(values, num_best_);
  state_.best_policies = all(order, Eigen::all);
  state_.best_returns = values(order);
}

OptimizerPtr make_policy_optimizer(const PolicySearchConfig& config, const Vector& initial) {
  check(config);
  if (!initial.allFinite()) throw InputError("policy search: the initial policy isn't finite");
  const Index q = initial.size();
  return make_policy_optimizer(
      config, {0, initial, RowMatrix::Identity(q, q) * (config.initial_std * config.initial_std),
               RowMatrix(0, q), Vector(0)});
}

OptimizerPtr make_policy_optimizer(const PolicySearchConfig& config,
                                   const PolicySearchState& state) {
  switch (config.kind) {
    case PolicyOptimizerKind::power:
      return std::make_unique<Power>(config, state);
    case PolicyOptimizerKind::cross_entropy:
      return std::make_unique<CrossEntropy>(config, state);
    case PolicyOptimizerKind::none:
      break;
  }
  throw InputError("policy.optimizer = '', must be one of " +
                   join(names_of<PolicyOptimizerKind>()));
}

}  // namespace npdr::inference
