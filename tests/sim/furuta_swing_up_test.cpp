#include "sim/furuta_swing_up.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "sim/furuta.h"
#include "tests/message_of.h"
#include "tests/sim/angles.h"
#include "tests/sim/hybrid_controller.h"
#include "tests/sim/ode_checks.h"

namespace npdr::sim {
namespace {

FurutaSwingUp nominal_task() { return FurutaSwingUp(theta_of(Furuta())); }

// Value of the last lane of a block.
double command(const FurutaSwingUp& task, const Vector& policy, const Vector& state) {
  const RowMatrix policies = policy.replicate(1, kLaneBlock), y = state.replicate(1, kLaneBlock);
  RowMatrix commanded(1, kLaneBlock);
  task.act(view(policies), view(y), view(commanded));
  return commanded(0, kLaneBlock - 1);
}

double reward(const Vector& state, double voltage) {
  const RowMatrix y = state.replicate(1, kLaneBlock);
  const RowMatrix commanded = RowMatrix::Constant(1, kLaneBlock, voltage);
  Vector rewards(kLaneBlock);
  nominal_task().reward(view(y), view(commanded), rewards.data());
  return rewards(kLaneBlock - 1);
}

bool within_limits(const Vector& state) {
  const RowMatrix y = state.replicate(1, kLaneBlock);
  Vector flags(kLaneBlock);
  nominal_task().within_limits(view(y), flags.data());
  return flags(kLaneBlock - 1) == 1.0;
}

bool is_held(const Vector& state) {
  const RowMatrix y = state.replicate(1, kLaneBlock);
  Vector flags(kLaneBlock);
  nominal_task().is_held(view(y), flags.data());
  return flags(kLaneBlock - 1) == 1.0;
}

TEST(FurutaSwingUp, ActsAsTheHybridController) {
  const FurutaSwingUp task = nominal_task();
  Stream stream({1, "swing_up_test", 0, 0, 0});
  const Vector initial = initial_policy(task.info());
  for (int trial = 0; trial < 2000; ++trial) {
    Vector policy = initial, state(4);
    for (double& v : policy) v *= 0.5 + stream.uniform();
    for (double& v : state) v = 10.0 * (2.0 * stream.uniform() - 1.0);
    if (trial % 2 == 0) state(1) = kPi * (2.0 * stream.below(4) - 3.0) + 0.5 * stream.uniform();
    const double expected = hybrid_controller(policy, state);
    ASSERT_NEAR(command(task, policy, state), expected, 1e-11 * (1.0 + std::abs(expected)));
    ASSERT_NEAR(reward(state, expected), swing_up_reward(state, expected), 1e-12);
  }
}

TEST(FurutaSwingUp, SwingUpPumpsEnergyWithinItsAccelerationAndRestsAtRest) {
  const FurutaSwingUp task = nominal_task();
  const Vector policy{{0.025, 1e6, 0.0, 0.0, 0.0, 0.0, 0.0}};
  const double largest = 8.4 / 0.042 * 0.095 * 0.085 * 5.0;  // [V]
  // Too little energy: against the swing. Too much: with it.
  EXPECT_NEAR(command(task, policy, Vector{{0.0, 0.0, 0.0, 1.0}}), -largest, 1e-12);
  EXPECT_NEAR(command(task, policy, Vector{{0.0, 0.0, 0.0, -1.0}}), largest, 1e-12);
  EXPECT_NEAR(command(task, policy, Vector{{0.0, 0.0, 0.0, 60.0}}), largest, 1e-12);
  EXPECT_NEAR(command(task, policy, Vector{{0.0, 2.0, 0.0, 1.0}}), largest, 1e-12);
  EXPECT_EQ(command(task, policy, Vector{{0.0, 0.0, 0.0, 0.0}}), 0.0);
}

TEST(FurutaSwingUp, RewardOfOneStateByHand) {
  // 0.1^2 + 0.2^2 + 0.02 * 2^2 + 0.005 * 4^2 + 0.004 * 3^2 = 0.246
  EXPECT_NEAR(reward(Vector{{0.1, kPi - 0.2, 2.0, -4.0}}, 3.0), std::exp(-0.246), 1e-14);
  EXPECT_EQ(reward(Vector{{0.0, kPi, 0.0, 0.0}}, 0.0), 1.0);
  EXPECT_NEAR(reward(Vector::Zero(4), 0.0), std::exp(-kPi * kPi), 1e-15);
  EXPECT_EQ(reward(Vector::Zero(4), kInfinity), 0.0);
}

TEST(FurutaSwingUp, LimitsAreThoseOfTheDevice) {
  const Vector limits{{115.0 * kDegree, 4.0 * kPi, 20.0 * kPi, 20.0 * kPi}};
  for (Index s = 0; s < 4; ++s) {
    for (const double side : {-1.0, 1.0}) {
      Vector state = Vector::Zero(4);
      state(s) = side * limits(s) * (1.0 - 1e-12);
      EXPECT_TRUE(within_limits(state)) << s;
      state(s) = side * limits(s) * (1.0 + 1e-12);
      EXPECT_FALSE(within_limits(state)) << s;
    }
    Vector state = Vector::Zero(4);
    state(s) = kNaN;
    EXPECT_FALSE(within_limits(state)) << s;
  }
}

TEST(FurutaSwingUp, HeldIsUprightAndSlow) {
  for (const double turn : {-2.0, 0.0, 2.0}) {
    EXPECT_TRUE(is_held(Vector{{1.5, kPi * (1.0 + turn) + 9.9 * kDegree, 1.9, -1.9}}));
  }
  EXPECT_FALSE(is_held(Vector{{0.0, kPi + 10.1 * kDegree, 0.0, 0.0}}));
  EXPECT_FALSE(is_held(Vector{{0.0, kPi, 2.1, 0.0}}));
  EXPECT_FALSE(is_held(Vector{{0.0, kPi, 0.0, -2.1}}));
  EXPECT_FALSE(is_held(Vector::Zero(4)));
}

TEST(FurutaSwingUp, ModelOfTheControllerScalesItsVoltage) {
  const Furuta furuta;
  const FurutaSwingUp task(theta_of(furuta, {{"motor_resistance", 16.8}}));
  const Vector policy = initial_policy(task.info()), state{{0.5, 1.0, 0.0, 1.0}};
  EXPECT_NEAR(command(task, policy, state), 2.0 * command(nominal_task(), policy, state), 1e-12);
  const std::string message = message_of<InputError>([&] {
    FurutaSwingUp(theta_of(furuta, {{"motor_constant", 0.0}}));
  });
  EXPECT_TRUE(has(message, "motor_constant"));
}

}  // namespace
}  // namespace npdr::sim
