// A policy that is searched under uncertain parameters does its task in a domain that it never saw.
#include <gtest/gtest.h>

#include "inference/policy_search/policy_optimizer.h"
#include "sim/policy_evaluation.h"
#include "sim/simulator.h"

namespace npdr {
namespace {

// A device that the initial policy can't swing up.
Vector true_parameters() {
  return sim::complete_theta(*sim::make_simulator({.name = "furuta"}), {{"rotary_damping", 2e-4},
                                                                        {"pole_damping", 5e-6},
                                                                        {"motor_resistance", 9.5},
                                                                        {"pole_mass", 0.028},
                                                                        {"pole_length", 0.14}});
}

// As a posterior would be: a few percent around the truth.
RowMatrix uncertain_parameters(Index count) {
  RowMatrix theta = true_parameters().transpose().replicate(count, 1);
  for (Index k = 0; k < count; ++k) {
    Stream stream({1, "uncertain", 0, static_cast<std::uint64_t>(k), 0});
    for (Index p = 0; p < 9; ++p) theta(k, p) *= 1.0 + 0.04 * stream.normal();
  }
  return theta;
}

sim::PopulationValues values_of(const sim::PolicyTask& task, const RowMatrix& points,
                                const RowMatrix& theta, const StreamId& id, Index num_states) {
  return sim::evaluate_population(task, sim::from_search_space(task.info(), points), theta,
                                  task.initial_states(num_states, id));
}

class PolicySearch : public testing::TestWithParam<inference::PolicyOptimizerKind> {};
INSTANTIATE_TEST_SUITE_P(Furuta, PolicySearch,
                         testing::Values(inference::PolicyOptimizerKind::power,
                                         inference::PolicyOptimizerKind::cross_entropy));

// The current policy after 15 iterations.
Vector search(const sim::PolicyTask& task, inference::PolicyOptimizerKind kind,
              const RowMatrix& theta, const Vector& start, std::uint64_t seed) {
  const auto optimizer = inference::make_policy_optimizer({.kind = kind}, start);
  for (std::uint64_t i = 0; i < 15; ++i) {
    const RowMatrix candidates = optimizer->ask({seed, "search"});
    optimizer->tell(candidates,
                    values_of(task, candidates, theta, {seed, "states", 0, 0, i}, 2).mean_return);
  }
  return optimizer->current();
}

TEST_P(PolicySearch, SwingsUpAFurutaPendulumThatItNeverSaw) {
  const auto task = sim::make_policy_task({.name = "furuta"});
  const RowMatrix theta = uncertain_parameters(15), truth = true_parameters().transpose();
  const RowMatrix start =
      sim::to_search_space(task->info(), sim::initial_policy(task->info()).transpose());
  const auto in_target = [&](const RowMatrix& point) {
    return values_of(*task, point, truth, {1, "target"}, 20);
  };
  EXPECT_LT(in_target(start).mean_return(0), 200.0);
  EXPECT_EQ(in_target(start).success_rate(0), 0.0);
  // A search that small ends in a bad local optimum with about 10 % of the seeds (6 and 5 of 60),
  // so that 4 of 5 do with a probability of 5e-4: on another processor, whose rounding makes it
  // another search.
  int successes = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Vector policy = search(*task, GetParam(), theta, start.row(0).transpose(), seed);
    const auto after = in_target(policy.transpose());
    if (after.mean_return(0) > 500.0 && after.success_rate(0) >= 0.9) ++successes;
  }
  EXPECT_GE(successes, 2);
}

}  // namespace
}  // namespace npdr
