#include "inference/policy_search/cross_entropy.h"

#include <gtest/gtest.h>

namespace npdr::inference {
namespace {

// Four candidates of one parameter, of which two are elites.
PolicySearchConfig elites_config(double smoothing) {
  return {.kind = PolicyOptimizerKind::cross_entropy,
          .population = 4,
          .initial_std = 1.0,
          .min_std = 0.01,
          .elite_fraction = 0.5,
          .smoothing = smoothing};
}

const RowMatrix& policies() {
  static const RowMatrix rows{{0.0}, {1.0}, {-2.0}, {3.0}, {5.0}};
  return rows;
}

TEST(CrossEntropy, RefitsTheElitesByHand) {
  const auto optimizer = make_policy_optimizer(elites_config(1.0), Vector(Vector::Zero(1)));
  optimizer->tell(policies(), Vector{{9.0, 4.0, 1.0, 3.0, -8.0}});  // elites 1 and 3
  EXPECT_DOUBLE_EQ(optimizer->current()(0), 2.0);
  EXPECT_DOUBLE_EQ(optimizer->state().covariance(0, 0), 1.0);
  EXPECT_EQ(optimizer->state().best_returns, Vector{{9.0}});
}

TEST(CrossEntropy, SmoothingKeepsAPartOfTheLastGaussian) {
  const auto optimizer = make_policy_optimizer(elites_config(0.75), Vector(Vector::Zero(1)));
  optimizer->tell(policies(), Vector{{9.0, -4.0, -1.0, -30.0, 2.0}});  // elites -2 and 5
  EXPECT_DOUBLE_EQ(optimizer->current()(0), 0.75 * 1.5);
  EXPECT_DOUBLE_EQ(optimizer->state().covariance(0, 0), 0.75 * 12.25 + 0.25 * 1.0);
}

TEST(CrossEntropy, OnlyTheOrderOfReturnsCounts) {
  const auto a = make_policy_optimizer(elites_config(0.7), Vector(Vector::Zero(1)));
  const auto b = make_policy_optimizer(elites_config(0.7), Vector(Vector::Zero(1)));
  a->tell(policies(), Vector{{0.0, 4.0, 1.0, 3.0, 2.0}});
  b->tell(policies(), Vector{{5.0, 1e6, -1e9, 7.0, 6.0}});
  EXPECT_EQ(a->current(), b->current());
  EXPECT_EQ(a->state().covariance, b->state().covariance);
}

}  // namespace
}  // namespace npdr::inference
