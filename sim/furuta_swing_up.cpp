#include "sim/furuta_swing_up.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sim/furuta.h"
#include "sim/lane_math.h"
#include "sim/simulator_check.h"

namespace npdr::sim {
namespace {

using enum Furuta::State;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kMaxAcceleration = 5.0;         // [m/s^2]
constexpr double kBalanceCone = 20.0 * kDegree;  // half angle around upright

struct Weights {
  double theta = 1.0, alpha = 1.0, theta_dot = 0.02, alpha_dot = 0.005, voltage = 0.004;
};
constexpr Weights kCost;

constexpr double kThetaLimit = 115.0 * kDegree;
constexpr double kAlphaLimit = 4.0 * kPi;
constexpr double kRateLimit = 20.0 * kPi;  // [rad/s]

constexpr double kHeldAngle = 10.0 * kDegree;
constexpr double kHeldRate = 2.0;  // [rad/s]

std::vector<PolicyParameter> parameters() {
  return {
      {"energy_reference", "J", 0.025, true, "energy E_ref that the swing-up aims at"},
      {"energy_gain", "m/(s^2 J)", 50.0, true, "gain mu of the energy's difference"},
      {"centring_gain", "m/(s^2 rad)", 0.4, false, "pull k_theta of the arm to its center"},
      {"balance_gain_theta", "V/rad", -2.0, false, "feedback of the arm's angle near the top"},
      {"balance_gain_alpha", "V/rad", 35.0, false, "feedback of the pole's angle near the top"},
      {"balance_gain_theta_dot", "V s/rad", -1.5, false, "feedback of the arm's rate near the top"},
      {"balance_gain_alpha_dot", "V s/rad", 3.0, false, "feedback of the pole's rate near the top"},
  };
}

// x clipped to +-limit; NaN stays NaN.
inline double clipped(double x, double limit) {
  return x > limit ? limit : (x < -limit ? -limit : x);
}

inline double sign(double x) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0); }

// pi - alpha in [-pi, pi], up to rounding.
inline double error_to_upright(double alpha) { return lane_wrap(kPi - alpha); }

}  // namespace

std::unique_ptr<ControlTask> Furuta::control_task(const Vector& model) const {
  return std::make_unique<FurutaSwingUp>(model);
}

FurutaSwingUp::FurutaSwingUp(const Vector& model) {
  const Furuta furuta;
  check_num_parameters(model.size(), furuta.info());
  const auto p = [&](const char* name) { return model(parameter_index(furuta.info(), name)); };
  if (!(p("motor_constant") > 0.0)) {
    throw InputError("the controller's model: motor_constant = 0 V s/rad, must be > 0");
  }
  const double pole_length = p("pole_length"), pole_mass = p("pole_mass");
  half_inertia_ = pole_mass * pole_length * pole_length / 24.0;
  weight_ = 0.5 * pole_mass * p("gravity") * pole_length;
  volts_per_acceleration_ =
      p("motor_resistance") / p("motor_constant") * p("rotary_mass") * p("rotary_length");
  info_.policy = "hybrid controller: swing-up by energy, balance by state feedback";
  info_.success = "upright within 10 deg, rates within 2 rad/s, over the last second";
  info_.parameters = parameters();
  info_.dt = furuta.info().dt;
  info_.num_steps = furuta.info().num_steps;
}

double FurutaSwingUp::action_limit() const { return kMaxVoltage; }

void FurutaSwingUp::act(ConstLanes policies, ConstLanes y, Lanes commanded) const {
  static const double balance_threshold = 1.0 + std::cos(kPi - kBalanceCone);
  const double half_inertia = half_inertia_, weight = weight_, volts = volts_per_acceleration_;
  const double threshold = balance_threshold;
  const double *const
      reference = policies.row(kEnergyReference),
      *const energy_gain = policies.row(kEnergyGain),
      *const centering = policies.row(kCenteringGain), *const k0 = policies.row(kBalanceGains),
      *const k1 = policies.row(kBalanceGains + 1), *const k2 = policies.row(kBalanceGains + 2),
      *const k3 = policies.row(kBalanceGains + 3);
  const double *const theta = y.row(kTheta), *const alpha = y.row(kAlpha),
                      *const theta_dot = y.row(kThetaDot), *const alpha_dot = y.row(kAlphaDot);
  double* const voltage = commanded.row(0);
  for_each_lane(y.lanes, [=](Index i) {
    const double cos_alpha = lane_sincos(alpha[i]).cos;
    const double rate = alpha_dot[i];
    const double energy = half_inertia * rate * rate + weight * (1.0 - cos_alpha);
    const double pump = energy_gain[i] * (energy - reference[i]) * sign(rate * cos_alpha);
    const double swing_up = volts * clipped(pump - centering[i] * theta[i], kMaxAcceleration);
    const double balance = k1[i] * error_to_upright(alpha[i]) -
                           (k0[i] * theta[i] + k2[i] * theta_dot[i] + k3[i] * rate);
    voltage[i] = std::abs(1.0 + cos_alpha) < threshold ? balance : swing_up;
  });
}

void FurutaSwingUp::reward(ConstLanes y, ConstLanes commanded, double* rewards) const {
  const double *const theta = y.row(kTheta), *const alpha = y.row(kAlpha),
                      *const theta_dot = y.row(kThetaDot), *const alpha_dot = y.row(kAlphaDot);
  const double* const voltage = commanded.row(0);
  for_each_lane(y.lanes, [=](Index i) {
    const double pole = error_to_upright(alpha[i]);
    const double cost = kCost.theta * theta[i] * theta[i] + kCost.alpha * pole * pole +
                        kCost.theta_dot * theta_dot[i] * theta_dot[i] +
                        kCost.alpha_dot * alpha_dot[i] * alpha_dot[i] +
                        kCost.voltage * voltage[i] * voltage[i];
    rewards[i] = lane_exp(-cost);
  });
}

void FurutaSwingUp::within_limits(ConstLanes y, double* flags) const {
  const double *const theta = y.row(kTheta), *const alpha = y.row(kAlpha),
                      *const theta_dot = y.row(kThetaDot), *const alpha_dot = y.row(kAlphaDot);
  for_each_lane(y.lanes, [=](Index i) {
    const bool within = (std::abs(theta[i]) <= kThetaLimit) & (std::abs(alpha[i]) <= kAlphaLimit) &
                        (std::abs(theta_dot[i]) <= kRateLimit) &
                        (std::abs(alpha_dot[i]) <= kRateLimit);
    flags[i] = within ? 1.0 : 0.0;
  });
}

void FurutaSwingUp::is_held(ConstLanes y, double* flags) const {
  const double *const alpha = y.row(kAlpha), *const theta_dot = y.row(kThetaDot),
                      *const alpha_dot = y.row(kAlphaDot);
  for_each_lane(y.lanes, [=](Index i) {
    const bool held = (std::abs(error_to_upright(alpha[i])) <= kHeldAngle) &
                      (std::abs(theta_dot[i]) <= kHeldRate) & (std::abs(alpha_dot[i]) <= kHeldRate);
    flags[i] = held ? 1.0 : 0.0;
  });
}

Vector FurutaSwingUp::initial_state(Stream& stream) const { return Furuta::initial_state(stream); }

}  // namespace npdr::sim
