#include "sim/furuta_regression.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "sim/savitzky_golay.h"
#include "sim/simulator_check.h"

namespace npdr::sim {
namespace {

constexpr Index kNumWeights = 6;
constexpr Index kDegree = 3;

// Motion at the middle of a window of states.
struct Motion {
  double theta, alpha, theta_dot, alpha_dot, theta_ddot, alpha_ddot;
};

Motion motion_in(const Eigen::Ref<const RowMatrix>& states, const SavitzkyGolay& smoother) {
  const Eigen::RowVectorXd smooth = smoother.smooth.transpose() * states;
  const Eigen::RowVectorXd slope = smoother.slope.transpose() * states;
  return {smooth(0), smooth(1), smooth(2), smooth(3), slope(2), slope(3)};
}

void write_regressors(const Motion& q, Eigen::Ref<Eigen::RowVectorXd> arm,
                      Eigen::Ref<Eigen::RowVectorXd> pole) {
  const double s = std::sin(q.alpha), c = std::cos(q.alpha);
  arm << q.theta_ddot, q.theta_ddot * s * s + 2.0 * q.theta_dot * q.alpha_dot * s * c,
      q.alpha_ddot * c - q.alpha_dot * q.alpha_dot * s, 0.0, q.theta_dot, 0.0;
  pole << 0.0, 4.0 / 3.0 * q.alpha_ddot - q.theta_dot * q.theta_dot * s * c, q.theta_ddot * c, s,
      0.0, q.alpha_dot;
}

}  // namespace

std::unique_ptr<RegressionForm> Furuta::regression_form() const {
  return std::make_unique<FurutaRegression>();
}

std::vector<Index> FurutaRegression::identified() const {
  std::vector<Index> positions;
  for (const char* name : {"rotary_damping", "pole_damping", "rotary_mass", "pole_mass",
                           "rotary_length", "pole_length"}) {
    positions.push_back(position(name));
  }
  return positions;
}

Vector FurutaRegression::applied_voltages(const Rollout& rollout, const Vector& known) const {
  const RowMatrix theta = known.replicate(1, kLaneBlock);
  RowMatrix constants(model_.num_constants(), kLaneBlock), applied(1, kLaneBlock);
  model_.prepare(view(theta), view(constants));
  Vector voltages(rollout.num_steps());
  for (Index t = 0; t < voltages.size(); ++t) {
    model_.apply_action(in_every_lane(rollout.actions), t, view(constants), view(applied));
    voltages(t) = applied(0, 0);
  }
  return voltages;
}

RegressionRows FurutaRegression::rows(const Target& target, const Vector& known,
                                      Index window) const {
  check_num_parameters(known.size(), model_.info());
  check_target(target, model_.info(), 1);
  const SavitzkyGolay smoother = savitzky_golay(window, kDegree, target.dt);
  const Vector step_average = smoother.step_average(target.dt);
  const Index count = target.num_steps() + 2 - window;  // states with enough neighbors
  if (count < 1) {
    throw InputError("smoothing window = " + std::to_string(window) + " states, must be <= " +
                     std::to_string(target.num_steps() + 1) + ", the states of a rollout");
  }
  const double gamma = known(position("motor_constant")) / known(position("motor_resistance"));
  const double friction = known(position("coulomb_friction"));
  const double stiffness = known(position("cable_stiffness"));
  const double rest_angle = known(position("cable_rest_angle"));
  RegressionRows result{RowMatrix(2 * count * target.num_rollouts(), kNumWeights),
                        Vector::Zero(2 * count * target.num_rollouts())};
  Index row = 0;
  for (const Rollout& rollout : target.rollouts) {
    const Vector voltages = applied_voltages(rollout, known);
    for (Index t = 0; t < count; ++t, row += 2) {
      const Motion q = motion_in(rollout.states.middleRows(t, window), smoother);
      write_regressors(q, result.regressors.row(row), result.regressors.row(row + 1));
      result.response(row) = gamma * step_average.dot(voltages.segment(t, window - 1)) -
                             friction * std::tanh(kCoulombSlope * q.theta_dot) -
                             stiffness * (q.theta - rest_angle);
    }
  }
  return result;
}

Vector FurutaRegression::recover(const Vector& w, const Vector& known) const {
  check_num_parameters(known.size(), model_.info());
  if (w.size() != kNumWeights) throw ShapeError("Furuta regression: w must have 6 values");
  const double g = known(position("gravity")), k_m = known(position("motor_constant"));
  Vector theta = known;
  const double pole_mass = w(3) * w(3) / (w(1) * g * g);
  theta(position("rotary_length")) = w(2) / w(3) * g;
  theta(position("pole_length")) = 2.0 * w(1) / w(3) * g;
  theta(position("pole_mass")) = pole_mass;
  theta(position("rotary_mass")) = 12.0 * pole_mass * (w(0) * w(1) / (w(2) * w(2)) - 1.0);
  theta(position("pole_damping")) = w(5);
  theta(position("rotary_damping")) = w(4) - k_m * k_m / known(position("motor_resistance"));
  return theta;
}

}  // namespace npdr::sim
