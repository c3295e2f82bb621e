#include "analysis/begins_at_rest.h"

#include <gtest/gtest.h>

namespace npdr::analysis {
namespace {

// theta = a t^2 + b t beside a channel that stands still.
Rollout motion(double a, double b) {
  Rollout rollout{"0", RowMatrix::Zero(100, 2), RowMatrix::Zero(99, 1)};
  for (Index t = 0; t < 100; ++t) {
    const auto time = static_cast<double>(t);
    rollout.states(t, 0) = a * time * time + b * time;
  }
  return rollout;
}

TEST(BeginsAtRest, LooksAtTheFirstStep) {
  EXPECT_TRUE(begins_at_rest(motion(0.01, 0.0)));
  EXPECT_FALSE(begins_at_rest(motion(0.0, 0.01)));
  EXPECT_FALSE(begins_at_rest(motion(-0.001, 0.2))) << "it slows down";
  EXPECT_TRUE(begins_at_rest(motion(0.0, 0.0)));
  EXPECT_TRUE(begins_at_rest({"0", RowMatrix::Zero(1, 2), RowMatrix::Zero(0, 1)}));
}

}  // namespace
}  // namespace npdr::analysis
