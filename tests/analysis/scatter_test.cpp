// What recordings show of their noise and beginning.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/begins_at_rest.h"
#include "analysis/scatter.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

Vector swing_with_noise(Index n, double noise) {
  Stream stream({3, "scatter_test", 0, 0, 0});
  Vector series(n);
  for (Index t = 0; t < n; ++t) {
    series(t) = std::sin(0.05 * static_cast<double>(t)) + noise * stream.normal();
  }
  return series;
}

// The median of third differences is off by 4 / sqrt(n) at most, as they depend on each other: 1e-4
// of false alarms.
TEST(Scatter, IsTheNoiseOfASmoothMotion) {
  for (const double noise : {0.001, 0.01, 0.1}) {
    EXPECT_NEAR(scatter(swing_with_noise(4000, noise)), noise, 0.1 * noise);
  }
  EXPECT_LT(scatter(swing_with_noise(4000, 0.0)), 1e-4) << "the smallest step counts as a tick";
  EXPECT_EQ(scatter(Vector::Ones(100)), 0.0);
  EXPECT_EQ(scatter(swing_with_noise(3, 0.1)), 0.0) << "too short";
  Vector glitch = swing_with_noise(4000, 0.01);
  glitch(100) = 1000.0;
  EXPECT_NEAR(scatter(glitch), 0.01, 0.001);
}

TEST(Scatter, OfAnEncoderIsItsRounding) {
  Vector still = Vector::Zero(100);
  still(40) = 0.5;
  EXPECT_EQ(smallest_step(still), 0.5);
  EXPECT_DOUBLE_EQ(scatter(still), 0.5 / std::sqrt(12.0));
  EXPECT_EQ(smallest_step(Vector::Ones(10)), 0.0);
}

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
