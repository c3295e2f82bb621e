#include "inference/policy_search/power.h"

#include <gtest/gtest.h>

namespace npdr::inference {
namespace {

// One parameter, three candidates of which two are remembered; the current policy is 0.
PolicySearchConfig small_config() {
  return {.population = 3, .initial_std = 1.0, .min_std = 0.01, .num_importance_samples = 2};
}

TEST(Power, UpdatesByHand) {
  const auto optimizer = make_policy_optimizer(small_config(), Vector(Vector::Zero(1)));
  const RowMatrix first{{0.0}, {1.0}, {-2.0}, {3.0}};
  optimizer->tell(first, Vector{{2.0, 4.0, 1.0, 3.0}});
  // Best: 1 with return 4 and 3 with return 3. Covariance around 0, without the current policy.
  EXPECT_DOUBLE_EQ(optimizer->current()(0), (4.0 * 1.0 + 3.0 * 3.0) / 7.0);
  EXPECT_DOUBLE_EQ(optimizer->state().covariance(0, 0), (4.0 * 1.0 + 1.0 * 4.0 + 3.0 * 9.0) / 8.0);
  EXPECT_EQ(optimizer->state().best_policies, (RowMatrix{{1.0}, {3.0}}));

  const double mean = 13.0 / 7.0;
  const RowMatrix second{{mean}, {2.0}, {mean + 1.0}, {mean - 1.0}};
  optimizer->tell(second, Vector{{0.0, 5.0, 1.0, 2.0}});
  // Best of both iterations: 2 with return 5 and 1 with return 4. Covariance around the old mean.
  EXPECT_DOUBLE_EQ(optimizer->current()(0), (5.0 * 2.0 + 4.0 * 1.0) / 9.0);
  EXPECT_DOUBLE_EQ(optimizer->state().covariance(0, 0),
                   (5.0 * (2.0 - mean) * (2.0 - mean) + 1.0 + 2.0) / 8.0);
  EXPECT_EQ(optimizer->state().best_returns, (Vector{{5.0, 4.0}}));
  EXPECT_EQ(optimizer->state().iteration, 2);
}

TEST(Power, CurrentPolicyMayBeAmongTheBest) {
  const auto optimizer = make_policy_optimizer(small_config(), Vector(Vector::Zero(1)));
  const RowMatrix policies{{0.0}, {1.0}, {-2.0}, {3.0}};
  optimizer->tell(policies, Vector{{6.0, 4.0, 1.0, 3.0}});
  EXPECT_DOUBLE_EQ(optimizer->current()(0), (6.0 * 0.0 + 4.0 * 1.0) / 10.0);
}

TEST(Power, ReturnsAreClippedFromBelow) {
  const auto optimizer = make_policy_optimizer(small_config(), Vector(Vector::Zero(1)));
  const RowMatrix policies{{0.0}, {1.0}, {-2.0}, {3.0}};
  optimizer->tell(policies, Vector{{-9.0, -1.0, 0.0, -5.0}});
  // The best two are -2 and 1, and all weigh the same.
  EXPECT_DOUBLE_EQ(optimizer->current()(0), -0.5);
  EXPECT_DOUBLE_EQ(optimizer->state().covariance(0, 0), (1.0 + 4.0 + 9.0) / 3.0);
}

TEST(Power, CovarianceHasTheCorrelationOfWhatWasGood) {
  PolicySearchConfig config = small_config();
  config.population = 2;
  const auto optimizer = make_policy_optimizer(config, Vector(Vector::Zero(2)));
  const RowMatrix policies{{0.0, 0.0}, {1.0, 2.0}, {2.0, -1.0}};
  optimizer->tell(policies, Vector{{0.0, 3.0, 1.0}});
  const RowMatrix expected{{(3.0 + 4.0) / 4.0, (6.0 - 2.0) / 4.0},
                           {(6.0 - 2.0) / 4.0, (12.0 + 1.0) / 4.0}};
  EXPECT_LT((optimizer->state().covariance - expected).cwiseAbs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace npdr::inference
