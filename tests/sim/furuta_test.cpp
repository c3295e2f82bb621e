#include "sim/furuta.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "tests/sim/ode_checks.h"

namespace npdr::sim {
namespace {

enum State : Index { kTheta, kAlpha, kThetaDot, kAlphaDot };

// Equations (1) and (2) as the paper prints them, with the extensions' torques on the arm.
struct PaperEquations {
  PaperEquations(const Furuta& model, const Vector& theta, const Vector& y) {
    const auto p = [&](const char* name) { return theta(parameter_index(model.info(), name)); };
    const double m_r = p("rotary_mass"), m_p = p("pole_mass");
    const double l_r = p("rotary_length"), l_p = p("pole_length");
    const double k_m = p("motor_constant"), r_m = p("motor_resistance");
    const double w0 = (m_r / 12.0 + m_p) * l_r * l_r;
    const double w1 = 0.25 * m_p * l_p * l_p;
    const double w2 = 0.5 * m_p * l_p * l_r;
    const double w3 = 0.5 * m_p * l_p * p("gravity");
    const double w4 = k_m * k_m / r_m + p("rotary_damping");
    const double w5 = p("pole_damping");
    const double a = y(kAlpha), u = y(kThetaDot), v = y(kAlphaDot);
    mass << w0 + w1 * std::pow(std::sin(a), 2), w2 * std::cos(a),  //
        w2 * std::cos(a), 4.0 / 3.0 * w1;
    c << w1 * std::sin(2.0 * a) * u * v - w2 * std::sin(a) * v * v + w4 * u,
        -0.5 * w1 * std::sin(2.0 * a) * u * u + w3 * std::sin(a) + w5 * v;
    gamma = k_m / r_m;
    extra_torque = -p("coulomb_friction") * std::tanh(u / 0.3) -
                   p("cable_stiffness") * (y(kTheta) - p("cable_rest_angle"));
    potential = -w3 * std::cos(a);
  }

  Eigen::Vector2d acceleration(double voltage) const {
    const Eigen::Vector2d tau(gamma * voltage + extra_torque, 0.0);
    return mass.partialPivLu().solve(tau - c);
  }

  Eigen::Matrix2d mass;
  Eigen::Vector2d c;
  double gamma = 0.0, extra_torque = 0.0, potential = 0.0;
};

double energy(const Furuta& model, const Vector& theta, const Vector& y) {
  const PaperEquations paper(model, theta, y);
  return 0.5 * y.tail(2).dot(paper.mass * y.tail(2)) + paper.potential;
}

// Parameters within 30 % of nominal; extensions within the ranges of the extended study.
Vector random_theta(const Furuta& model, Stream& stream) {
  Vector theta = theta_of(model);
  for (Index p = 0; p < 9; ++p) theta(p) *= 0.7 + 0.6 * stream.uniform();
  theta.tail(3) << 2e-3 * stream.uniform(), 5e-3 * stream.uniform(), 0.6 * stream.uniform() - 0.3;
  return theta;
}

TEST(Furuta, RightHandSideIsThatOfThePapersEquations) {
  const Furuta model;
  Stream stream({1, "furuta_test", 0, 0, 0});
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector theta = random_theta(model, stream);
    Vector y(4);
    for (double& v : y) v = 20.0 * (2.0 * stream.uniform() - 1.0);
    const double voltage = 4.5 * (2.0 * stream.uniform() - 1.0);
    const Vector slope = rhs_of(model, theta, Vector::Constant(1, voltage), y);
    const Eigen::Vector2d expected = PaperEquations(model, theta, y).acceleration(voltage);
    ASSERT_EQ(slope(kTheta), y(kThetaDot));
    ASSERT_EQ(slope(kAlpha), y(kAlphaDot));
    ASSERT_LT((slope.tail(2) - expected).norm(), 1e-11 * (1.0 + expected.norm()));
  }
}

TEST(Furuta, KeepsItsEnergyWithoutFrictionAndMotor) {
  const Furuta model;
  const Vector theta =
      theta_of(model, {{"motor_constant", 0.0}, {"rotary_damping", 0.0}, {"pole_damping", 0.0}});
  const Eigen::Vector4d start(0.1, 2.8, 1.0, -2.0);
  const RowMatrix states = states_by(Integrator::erk4, 8, model, theta, free_motion(start, 1250));
  for (Index t = 0; t <= 1250; ++t) {  // 0.03 J above the lowest
    ASSERT_NEAR(energy(model, theta, states.row(t).transpose()), energy(model, theta, start), 1e-9);
  }
}

// With an arm that can't move, the pole is a uniform rod: see the pendulum's period.
TEST(Furuta, PoleOnAHeavyArmSwingsLikeAFreeRod) {
  const Furuta model;
  const double amplitude = 2.0, length = 0.129, period = 250.0 * model.info().dt;
  const double omega = 4.0 * std::comp_ellint_1(std::sin(amplitude / 2.0)) / period;
  const Vector theta = theta_of(model, {{"rotary_mass", 1e9},
                                        {"pole_damping", 0.0},
                                        {"gravity", 2.0 * length / 3.0 * omega * omega}});
  const RowMatrix states = states_by(Integrator::erk4, 4, model, theta,
                                     free_motion(Eigen::Vector4d(0.0, amplitude, 0.0, 0.0), 250));
  EXPECT_NEAR(states(250, kAlpha), amplitude, 1e-7);
  EXPECT_NEAR(states(250, kAlphaDot), 0.0, 1e-6);
  EXPECT_NEAR(states(250, kTheta), 0.0, 1e-7);
}

TEST(Furuta, VoltageSaturates) {
  const Furuta model;
  RowMatrix actions(3, 1);
  actions << 7.0, -7.0, 3.0;
  EXPECT_EQ(applied_action(model, theta_of(model), actions, 0), 4.5);
  EXPECT_EQ(applied_action(model, theta_of(model), actions, 1), -4.5);
  EXPECT_EQ(applied_action(model, theta_of(model), actions, 2), 3.0);
}

Excitation two_seconds(const Furuta& model) {
  Excitation excitation = model.excite(0, 1);
  excitation.actions.conservativeResize(500, 1);
  return excitation;
}

TEST(Furuta, AgreesWithAnAdaptiveReference) {
  const Furuta model;
  const Excitation excitation = two_seconds(model);
  for (std::uint64_t trial = 0; trial < 5; ++trial) {
    Stream stream({2, "furuta_test", 0, trial, 0});
    const Vector theta = random_theta(model, stream);
    const IntegrationError error(model, theta, excitation);
    // Rates are tens of rad/s. With one step, smoothed dry friction limits the accuracy.
    EXPECT_LT(error.of(Integrator::erk4, 1), 1e-2);
    EXPECT_LT(error.of(Integrator::erk4, 16), 1e-7);
    EXPECT_LT(error.of(Integrator::cvode, 1), 1e-3);
  }
}

TEST(Furuta, BehaviorDependsOnSeedAndRolloutAlone) {
  const Furuta model;
  const Excitation first = model.excite(2, 7);
  EXPECT_EQ(first.actions, model.excite(2, 7).actions);
  EXPECT_EQ(first.initial_state, model.excite(2, 7).initial_state);
  EXPECT_NE(first.actions, model.excite(3, 7).actions);
  EXPECT_NE(first.actions, model.excite(2, 8).actions);
}

TEST(Furuta, BehaviorExcitesArmAndPoleWithoutSaturating) {
  const Furuta model;
  constexpr double degree = std::numbers::pi / 180.0;
  double arm = 0.0, pole = 0.0;
  for (Index h = 0; h < 20; ++h) {
    const Excitation excitation = model.excite(h, 1);
    EXPECT_LT(excitation.actions.cwiseAbs().maxCoeff(), 4.5);
    const Eigen::Array4d limits = Eigen::Array4d(2.0, 1.0, 0.5, 0.5) * degree;
    EXPECT_TRUE((excitation.initial_state.array().abs() <= limits).all());
    const RowMatrix states = states_by(Integrator::erk4, 1, model, theta_of(model), excitation);
    arm += states.col(kTheta).cwiseAbs().maxCoeff() / 20.0;
    pole += states.col(kAlpha).cwiseAbs().maxCoeff() / 20.0;
  }
  EXPECT_GT(arm, 0.5);
  EXPECT_LT(arm, 2.0);
  EXPECT_GT(pole, 1.0);
}

}  // namespace
}  // namespace npdr::sim
