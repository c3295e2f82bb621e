#include "sim/minigolf/rolling.h"

#include <gtest/gtest.h>

#include <cmath>

namespace npdr::sim {
namespace {

TEST(Rolling, FrictionAloneDeceleratesUniformly) {
  const RollingLaw law(0.2, 0.0);
  const Rolled rolled = law.roll(1.0, 2.0);
  EXPECT_DOUBLE_EQ(rolled.speed, 0.6);
  EXPECT_DOUBLE_EQ(rolled.distance, 1.6);
}

TEST(Rolling, DampingAloneDecaysExponentially) {
  const RollingLaw law(0.0, 0.3);
  const Rolled rolled = law.roll(1.0, 2.0);
  EXPECT_DOUBLE_EQ(rolled.speed, std::exp(-0.6));
  EXPECT_DOUBLE_EQ(rolled.distance, (1.0 - std::exp(-0.6)) / 0.3);
}

TEST(Rolling, NothingSlowsDownASphereWithoutEither) {
  const Rolled rolled = RollingLaw(0.0, 0.0).roll(0.5, 3.0);
  EXPECT_DOUBLE_EQ(rolled.speed, 0.5);
  EXPECT_DOUBLE_EQ(rolled.distance, 1.5);
}

TEST(Rolling, EndsAtRestAndStaysThere) {
  const RollingLaw law(0.2, 0.0);
  const Rolled rolled = law.roll(1.0, 10.0);
  EXPECT_EQ(rolled.speed, 0.0);
  EXPECT_DOUBLE_EQ(rolled.distance, 2.5);
  EXPECT_EQ(law.roll(0.0, 1.0).distance, 0.0);
}

// Two steps are one of their joint length, also across the switch between series and functions.
TEST(Rolling, StepsFollowEachOther) {
  for (const double b : {0.0, 1e-6, 0.01, 0.0751, 3.0}) {
    const RollingLaw law(0.05, b);
    const Rolled first = law.roll(0.7, 0.004);
    const Rolled second = law.roll(first.speed, 0.9);
    const Rolled whole = law.roll(0.7, 0.904);
    EXPECT_NEAR(second.speed, whole.speed, 1e-14) << b;
    EXPECT_NEAR(first.distance + second.distance, whole.distance, 1e-11) << b;
  }
}

// dv/dt = -(a + b v) by central differences, and ds/dt = v.
TEST(Rolling, FollowsItsDifferentialEquation) {
  const RollingLaw law(0.05, 0.4);
  const double t = 0.8, h = 1e-5;
  const Rolled before = law.roll(0.7, t - h), at = law.roll(0.7, t), after = law.roll(0.7, t + h);
  EXPECT_NEAR((after.speed - before.speed) / (2 * h), -(0.05 + 0.4 * at.speed), 1e-9);
  EXPECT_NEAR((after.distance - before.distance) / (2 * h), at.speed, 1e-9);
}

}  // namespace
}  // namespace npdr::sim
