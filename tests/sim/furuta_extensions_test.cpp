#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "sim/furuta.h"
#include "tests/sim/ode_checks.h"

namespace npdr::sim {
namespace {

// The recorded voltages 0, 1, 2, ... [V], so that a sample tells its own time.
RowMatrix ramp(Index steps) {
  RowMatrix actions(steps, 1);
  for (Index t = 0; t < steps; ++t) actions(t, 0) = 0.25 * static_cast<double>(t);
  return actions;
}

double delayed(double delay, Index t) {
  const Furuta model;
  return applied_action(model, theta_of(model, {{"action_delay", delay}}), ramp(16), t);
}

TEST(FurutaExtensions, DelayOfWholeStepsIsAnEarlierSample) {
  EXPECT_EQ(delayed(0.0, 9), 0.25 * 9.0);
  EXPECT_EQ(delayed(1.0, 9), 0.25 * 8.0);
  EXPECT_EQ(delayed(6.0, 9), 0.25 * 3.0);
}

TEST(FurutaExtensions, DelayBetweenStepsBlendsTheTwoSamples) {
  EXPECT_DOUBLE_EQ(delayed(0.25, 9), 0.25 * 8.75);
  EXPECT_DOUBLE_EQ(delayed(3.9, 9), 0.25 * 5.1);
}

TEST(FurutaExtensions, DelayHoldsTheFirstSampleBeforeTheRecording) {
  const Furuta model;
  RowMatrix actions(3, 1);
  actions << 2.0, 4.0, 1.0;
  const Vector theta = theta_of(model, {{"action_delay", 1.5}});
  EXPECT_EQ(applied_action(model, theta, actions, 0), 2.0);
  EXPECT_EQ(applied_action(model, theta, actions, 1), 2.0);
  EXPECT_EQ(applied_action(model, theta, actions, 2), 3.0);
}

TEST(FurutaExtensions, DelayThatMakesNoSenseReadsNothingOutsideTheRecording) {
  EXPECT_EQ(delayed(-3.0, 9), 0.25 * 9.0);
  EXPECT_EQ(delayed(1e300, 9), 0.0);
  EXPECT_TRUE(std::isfinite(delayed(kNaN, 9)));
}

TEST(FurutaExtensions, DelayReachesAcrossTheBordersOfSegments) {
  const Furuta model;
  Rollout recording{"", RowMatrix::Zero(21, 4), ramp(20)};
  recording.actions.bottomRows(10).setZero();  // felt only through the delay
  const auto last_state = [&](double delay) {
    BatchReplay batch(model, theta_of(model, {{"action_delay", delay}}).transpose());
    const auto integrator = make_integrator(Integrator::erk4, batch, 0.004, 1);
    Vector state(4);
    batch.run(*integrator, recording, 10, [&](Index t, ConstLanes y) {
      if (t == 20) state << y.row(0)[0], y.row(1)[0], y.row(2)[0], y.row(3)[0];
    });
    return state;
  };
  EXPECT_EQ(last_state(0.0), Vector::Zero(4));
  EXPECT_GT(last_state(3.0)(2), 0.01);
}

TEST(FurutaExtensions, VoltagesInsideTheDeadZoneGiveNothing) {
  const Furuta model;
  const Vector theta =
      theta_of(model, {{"voltage_dead_zone_neg", -0.3}, {"voltage_dead_zone_pos", 0.2}});
  RowMatrix actions(6, 1);
  actions << -0.31, -0.29, -0.0, 0.19, 0.21, 2.0;
  const double expected[] = {-0.31, 0.0, 0.0, 0.0, 0.21, 2.0};
  for (Index t = 0; t < 6; ++t) {
    EXPECT_EQ(applied_action(model, theta, actions, t), expected[t]) << t;
  }
}

TEST(FurutaExtensions, DeadZoneActsOnTheDelayedVoltage) {
  const Furuta model;
  RowMatrix actions(2, 1);
  actions << 0.1, 0.5;
  const auto voltage = [&](double delay) {
    return applied_action(
        model, theta_of(model, {{"voltage_dead_zone_pos", 0.35}, {"action_delay", delay}}), actions,
        1);
  };
  EXPECT_EQ(voltage(0.0), 0.5);
  EXPECT_EQ(voltage(0.5), 0.0);
}

TEST(FurutaExtensions, CoulombFrictionStopsTheArm) {
  const Furuta model;
  const Eigen::Vector4d start(0.0, 0.0, 2.0, 0.0);
  const auto travel = [&](double friction) {
    const Vector theta = theta_of(
        model, {{"coulomb_friction", friction}, {"motor_constant", 0.0}, {"pole_mass", 1e-4}});
    return states_by(Integrator::erk4, 1, model, theta, free_motion(start, 500))(500, 0);
  };
  EXPECT_NEAR(travel(0.0), 4.0, 0.5);  // hardly slowed in 2 s
  // A sliding mass stops after v^2 J / (2 tau), a bit later since tanh fades near rest.
  const double inertia = (0.095 / 12.0 + 1e-4) * 0.085 * 0.085;
  EXPECT_GT(travel(2e-3), 4.0 * inertia / (2.0 * 2e-3));
  EXPECT_LT(travel(2e-3), 1.5 * 4.0 * inertia / (2.0 * 2e-3));
}

}  // namespace
}  // namespace npdr::sim
