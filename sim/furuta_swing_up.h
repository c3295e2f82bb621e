/// Swing-up and balance of the Furuta pendulum: the task of the paper's Section 4.3 and Table A5,
/// with a hybrid controller of 7 parameters.
///
/// State (theta, alpha, theta_dot, alpha_dot) as in furuta.h, goal x_des = (0, pi, 0, 0).
/// Parameters of the controller: E_ref [J], mu, k_theta, and the gains k (4) [V per unit of the
/// state].
///
/// Swing-up by energy (Astrom and Furuta 2000), away from the top:
///   E = J alpha_dot^2 / 2 + M_p g L_p (1 - cos alpha) / 2,   J = M_p L_p^2 / 12
///   a = clip(mu (E - E_ref) sign(alpha_dot cos alpha) - k_theta theta, +-5 m/s^2)
///   u = (R_m / k_m) M_r L_r a,
/// with sign(0) = 0. Balance by state feedback where |1 + cos alpha| < 1 + cos(pi - 20 deg):
///   u = k . (x_des - x), alpha's difference wrapped to [-pi, pi].
/// M_p, L_p, g, R_m, k_m, M_r and L_r are those of the controller's own model: nominal, whatever is
/// simulated. The motor is given u clipped to +-4.5 V; delay and dead zone of the simulated system
/// act on that.
///
/// Reward exp(-(e' Q e + R u^2)) with e = x_des - x, alpha's difference wrapped,
/// Q = diag(1, 1, 0.02, 0.005) [rad^-2, (rad/s)^-2], R = 0.004 V^-2, and u before it is clipped.
/// Limits: |theta| <= 115 deg, |alpha| <= 4 pi, |theta_dot|, |alpha_dot| <= 20 pi rad/s.
/// Success: limits are kept, and in all states of the last second (250 of them; all, where there
/// are fewer) the pole is within 10 deg of upright and both rates are within 2 rad/s. A balanced
/// pole that dead zones keep in a limit cycle of a few degrees at its own frequency (10.7 rad/s at
/// nominal) passes, one that falls doesn't.
/// Initial states: uniform within +-(2 deg, 1 deg, 0.5 deg/s, 0.5 deg/s).
#pragma once

#include "sim/control_task.h"

namespace npdr::sim {

class FurutaSwingUp final : public ControlTask {
 public:
  /// Positions in a policy.
  enum Gain : Index { kEnergyReference, kEnergyGain, kCenteringGain, kBalanceGains, kNumGains = 7 };

  /// `model` (P): the Furuta's domain parameters as the controller believes them to be.
  explicit FurutaSwingUp(const Vector& model);

  const PolicyTaskInfo& info() const override { return info_; }
  double action_limit() const override;
  Index hold_steps() const override { return 250; }
  void act(ConstLanes policies, ConstLanes y, Lanes commanded) const override;
  void reward(ConstLanes y, ConstLanes commanded, double* rewards) const override;
  void within_limits(ConstLanes y, double* flags) const override;
  void is_held(ConstLanes y, double* flags) const override;
  Vector initial_state(Stream& stream) const override;

 private:
  PolicyTaskInfo info_;
  double half_inertia_;            // J / 2 [kg m^2]
  double weight_;                  // M_p g L_p / 2 [N m]
  double volts_per_acceleration_;  // [V s^2/m]
};

}  // namespace npdr::sim
