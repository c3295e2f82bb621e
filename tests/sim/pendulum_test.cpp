#include "sim/pendulum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/ode_checks.h"

namespace npdr::sim {
namespace {

// The closed-form period of a uniform rod at any amplitude: T = 4 K(sin(theta_0 / 2)) / omega_0
// with omega_0^2 = 3 g / (2 l). Gravity is chosen so that T is 100 steps.
TEST(Pendulum, HasTheClosedFormPeriodAtSmallAndLargeAngles) {
  const Pendulum model;
  const double length = 0.8;
  for (const double amplitude : {1e-3, 0.5, 1.5, 3.0}) {
    const double period = 100.0 * model.info().dt;
    const double omega = 4.0 * std::comp_ellint_1(std::sin(amplitude / 2.0)) / period;
    const double gravity = 2.0 * length / 3.0 * omega * omega;
    const Vector theta = theta_of(model, {{"pole_length", length}, {"gravity", gravity}});
    const RowMatrix states = states_by(Integrator::erk4, 20, model, theta,
                                       free_motion(Eigen::Vector2d(amplitude, 0.0), 100));
    EXPECT_NEAR(states(25, 0), 0.0, 1e-7 * amplitude) << amplitude;
    EXPECT_NEAR(states(50, 0), -amplitude, 1e-7 * amplitude) << amplitude;
    EXPECT_NEAR(states(100, 0), amplitude, 1e-7 * amplitude) << amplitude;
    EXPECT_NEAR(states(100, 1), 0.0, 1e-6 * amplitude * omega) << amplitude;
  }
}

TEST(Pendulum, SmallSwingsDecayAtTheRateOfTheDamping) {
  const Pendulum model;
  const double damping = 0.3, inertia = 1.0 / 3.0, decay = damping / (2.0 * inertia);
  const double omega = std::sqrt(1.5 * 9.81 - decay * decay);
  const RowMatrix states =
      states_by(Integrator::erk4, 10, model, theta_of(model, {{"damping", damping}}),
                free_motion(Eigen::Vector2d(1e-4, 0.0), 100));
  for (Index k = 0; k <= 100; ++k) {
    const double t = static_cast<double>(k) * model.info().dt;
    const double exact =
        1e-4 * std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
    ASSERT_NEAR(states(k, 0), exact, 1e-11) << k;
  }
}

TEST(Pendulum, BehaviorIsTheSineOfTableA3FromRest) {
  const Pendulum model;
  const Excitation excitation = model.excite(3, 99);
  EXPECT_EQ(excitation.initial_state, Vector::Zero(2));
  EXPECT_EQ(excitation.actions.rows(), 400);
  EXPECT_EQ(excitation.actions(0, 0), 0.0);
  EXPECT_NEAR(excitation.actions(10, 0), 4.5 * std::sin(0.4 * std::numbers::pi), 1e-14);
  EXPECT_EQ(excitation.actions, model.excite(0, 1).actions);
}

TEST(Pendulum, AgreesWithAnAdaptiveReferenceToTheOrderOfEachMethod) {
  const Pendulum model;
  const Vector theta = theta_of(model, {{"damping", 0.1}});
  const Excitation excitation = model.excite(0, 1);
  const IntegrationError error(model, theta, excitation);
  EXPECT_NEAR(std::log2(error.of(Integrator::erk2, 4) / error.of(Integrator::erk2, 8)), 2.0, 0.1);
  EXPECT_NEAR(std::log2(error.of(Integrator::erk4, 2) / error.of(Integrator::erk4, 4)), 4.0, 0.2);
  EXPECT_NEAR(std::log2(error.of(Integrator::erk5, 1) / error.of(Integrator::erk5, 2)), 5.0, 0.4);
  EXPECT_LT(error.of(Integrator::erk4, 1), 1e-4);
  EXPECT_LT(error.of(Integrator::erk4, 16), 1e-9);
  EXPECT_LT(error.of(Integrator::cvode, 1), 1e-5);
}

}  // namespace
}  // namespace npdr::sim
