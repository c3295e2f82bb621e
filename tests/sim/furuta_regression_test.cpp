#include "sim/furuta_regression.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "sim/savitzky_golay.h"
#include "tests/message_of.h"
#include "tests/sim/ode_checks.h"

namespace npdr::sim {
namespace {

// Savitzky and Golay's own table for five points: (-3, 12, 17, 12, -3) / 35, and for a cubic's
// slope (1, -8, 0, 8, -1) / 12.
TEST(SavitzkyGolay, HasThePublishedCoefficients) {
  const SavitzkyGolay filter = savitzky_golay(5, 3, 1.0);
  const Eigen::Matrix<double, 5, 1> smooth(-3, 12, 17, 12, -3), slope(1, -8, 0, 8, -1);
  EXPECT_LT((filter.smooth - smooth / 35.0).norm(), 1e-13);
  EXPECT_LT((filter.slope - slope / 12.0).norm(), 1e-13);
}

// Values that are held over each step integrate to a polygon, whose slope the filter takes.
TEST(SavitzkyGolay, StepAverageIsTheSlopeOfTheIntegral) {
  constexpr double dt = 0.01;
  const SavitzkyGolay filter = savitzky_golay(9, 3, dt);
  Stream stream({1, "steps", 0, 0, 0});
  Vector held(8), integral = Vector::Zero(9);
  for (Index k = 0; k < 8; ++k) {
    held(k) = stream.normal();
    integral(k + 1) = integral(k) + dt * held(k);
  }
  EXPECT_NEAR(filter.step_average(dt).dot(held), filter.slope.dot(integral), 1e-12);
  EXPECT_NEAR(filter.step_average(dt).sum(), 1.0, 1e-12);
}

const std::map<std::string, double> kTruth = {{"rotary_damping", 2e-4}, {"pole_damping", 5e-6},
                                              {"rotary_mass", 0.1},     {"pole_mass", 0.022},
                                              {"rotary_length", 0.08},  {"pole_length", 0.12}};

Target behavior(const std::map<std::string, double>& truth, Index num_rollouts = 3) {
  SimulatorConfig config;
  config.name = "furuta";
  config.substeps = 4;
  const auto simulator = make_simulator(config);
  return simulator->behave(complete_theta(*simulator, truth), num_rollouts, 1);
}

// Least squares alone: no noise, so nothing to regularize.
Vector recovered(const Target& target, const Vector& known, Index window) {
  const FurutaRegression form;
  const RegressionRows rows = form.rows(target, known, window);
  const Eigen::MatrixXd phi = rows.regressors;
  return form.recover(phi.colPivHouseholderQr().solve(rows.response), known);
}

TEST(FurutaRegression, RecoversTheTruthOfASimulation) {
  const Furuta model;
  const Vector truth = theta_of(model, kTruth);
  const Vector found = recovered(behavior(kTruth), theta_of(model), 5);
  for (const Index p : FurutaRegression().identified()) {
    // The rest is the curvature within 20 ms; damping of the pole is 1e-6 of the torques.
    const bool is_tiny =
        model.info().parameters[static_cast<std::size_t>(p)].name == "pole_damping";
    EXPECT_NEAR(found(p) / truth(p), 1.0, is_tiny ? 0.02 : 0.002)
        << model.info().parameters[static_cast<std::size_t>(p)].name;
  }
}

TEST(FurutaRegression, TakesWhatIsKnownIntoAccount) {
  std::map<std::string, double> extended = {
      {"motor_resistance", 7.0}, {"motor_constant", 0.05},        {"gravity", 9.7},
      {"action_delay", 2.4},     {"coulomb_friction", 1e-3},      {"cable_stiffness", 2e-3},
      {"cable_rest_angle", 0.2}, {"voltage_dead_zone_neg", -0.1}, {"voltage_dead_zone_pos", 0.2}};
  const Vector known = theta_of(Furuta(), extended);
  extended.insert(kTruth.begin(), kTruth.end());
  const Vector truth = theta_of(Furuta(), extended);
  const Target target = behavior(extended);
  const Vector found = recovered(target, known, 5);
  const Vector naive = recovered(target, theta_of(Furuta()), 5);
  for (const Index p : FurutaRegression().identified()) {
    const bool is_damping = p < 2;  // small beside the smoothed dry friction
    EXPECT_NEAR(found(p) / truth(p), 1.0, is_damping ? 0.1 : 0.02) << p;
  }
  EXPECT_GT(std::abs(naive(4) / truth(4) - 1.0), 0.1) << "rotary_mass, taking nominal values";
}

TEST(FurutaRegression, RecoveryUndoesEquation2) {
  const Furuta model;
  const Vector theta = theta_of(model, kTruth);
  const double m_r = 0.1, m_p = 0.022, l_r = 0.08, l_p = 0.12, g = 9.81;
  Vector w(6);
  w << (m_r / 12.0 + m_p) * l_r * l_r, m_p * l_p * l_p / 4.0, m_p * l_p * l_r / 2.0,
      m_p * l_p * g / 2.0, 0.042 * 0.042 / 8.4 + 2e-4, 5e-6;
  EXPECT_LT((FurutaRegression().recover(w, theta_of(model)) - theta).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(FurutaRegression, RowsAreAsManyAsWindowsFit) {
  const Target target = behavior(kTruth, 2);
  const RegressionRows rows = FurutaRegression().rows(target, theta_of(Furuta()), 11);
  EXPECT_EQ(rows.regressors.rows(), 2 * 2 * (1251 - 10));
  EXPECT_EQ(rows.response.size(), rows.regressors.rows());
}

TEST(FurutaRegression, RejectsWindowsThatDontFit) {
  const Target target = behavior(kTruth, 1);
  const auto message = [&](Index window) {
    return message_of<InputError>(
        [&] { FurutaRegression().rows(target, theta_of(Furuta()), window); });
  };
  EXPECT_TRUE(says(message(6), {"smoothing window = 6 states", "must be odd and > 4"}));
  EXPECT_TRUE(says(message(3), {"smoothing window = 3 states", "must be odd and > 4"}));
  EXPECT_TRUE(says(message(1253), {"smoothing window = 1253 states", "must be <= 1251"}));
}

TEST(RegressionForm, OnlyTheFurutaPendulumHasOne) {
  for (const std::string& name : simulator_names()) {
    SimulatorConfig config;
    config.name = name;
    EXPECT_EQ(make_simulator(config)->regression_form() != nullptr, name == "furuta") << name;
  }
}

}  // namespace
}  // namespace npdr::sim
