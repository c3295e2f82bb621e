#include "sim/policy_evaluation.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/sim/policy_rows.h"

namespace npdr::sim {
namespace {

TEST(PolicyEvaluation, ValueIsTheMeanOverAllPairsOfParametersAndStates) {
  const auto task = swing_up(400);
  PolicyRows rows = random_rows(5);
  rows.policies(1, 2) = -50.0;  // leaves the limits
  const RowMatrix policies = rows.policies.topRows(3), states = rows.initial_states.topRows(2);
  const PopulationValues values = evaluate_population(*task, policies, rows.theta, states);
  ASSERT_EQ(values.mean_return.size(), 3);
  EXPECT_EQ(values.num_impossible, 0);
  for (Index m = 0; m < 3; ++m) {
    double sum = 0.0, successes = 0.0, completed = 0.0;
    for (Index k = 0; k < 5; ++k) {
      for (Index s = 0; s < 2; ++s) {
        const PolicyRollouts one = task->run(rows.theta.row(k), states.row(s), policies.row(m));
        sum += one.returns(0);
        successes += one.success[0];
        completed += one.num_steps[0] == 400 ? 1.0 : 0.0;
      }
    }
    EXPECT_NEAR(values.mean_return(m), sum / 10.0, 1e-12 * sum);
    EXPECT_DOUBLE_EQ(values.success_rate(m), successes / 10.0);
    EXPECT_DOUBLE_EQ(values.completion_rate(m), completed / 10.0);
  }
  EXPECT_LT(values.completion_rate(1), 1.0);
  EXPECT_EQ(values.completion_rate(0), 1.0);
}

TEST(PolicyEvaluation, SameBitsWhateverElseIsInThePopulation) {
  const auto task = swing_up(20);
  const PolicyRows rows = random_rows(60);
  const RowMatrix states = rows.initial_states.topRows(40);  // 2400 rows a policy: several blocks
  const PopulationValues all =
      evaluate_population(*task, rows.policies.topRows(45), rows.theta, states);
  for (const Index m : {0, 19, 20, 21, 44}) {
    const PopulationValues one =
        evaluate_population(*task, rows.policies.row(m), rows.theta, states);
    EXPECT_EQ(one.mean_return(0), all.mean_return(m)) << m;
  }
}

TEST(PolicyEvaluation, ImpossibleParametersAreLeftOut) {
  const auto task = swing_up(100);
  PolicyRows rows = random_rows(4);
  const RowMatrix kept = rows.theta.topRows(3);
  rows.theta(3, 5) = -1.0;
  const PopulationValues with =
      evaluate_population(*task, rows.policies, rows.theta, rows.initial_states);
  const PopulationValues without =
      evaluate_population(*task, rows.policies, kept, rows.initial_states);
  EXPECT_EQ(with.num_impossible, 1);
  EXPECT_EQ(with.mean_return, without.mean_return);
  EXPECT_THROW(
      evaluate_population(*task, rows.policies, rows.theta.bottomRows(1), rows.initial_states),
      InputError);
  EXPECT_THROW(evaluate_population(*task, rows.policies, kept, RowMatrix(0, 4)), InputError);
}

}  // namespace
}  // namespace npdr::sim
