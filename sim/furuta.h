/// The Furuta pendulum (Quanser Qube) of the paper's Section 4.3 and Appendix B: a motor turns an
/// arm, at whose end a pole swings freely.
///
/// With q = (theta, alpha) [rad], arm and pole angle, zero when centered and hanging down, eq. (1):
///   M(q) q_ddot + c(q, q_dot) = (tau, 0)
///   M = [ w0 + w1 sin^2 alpha   w2 cos alpha ]
///       [ w2 cos alpha          4/3 w1       ]
///   c = [ w1 sin(2 alpha) theta_dot alpha_dot - w2 sin(alpha) alpha_dot^2 + w4 theta_dot ]
///       [ -w1 sin(2 alpha) theta_dot^2 / 2 + w3 sin(alpha) + w5 alpha_dot                ]
/// and eq. (2), where gamma u with gamma = k_m / R_m is the torque of the motor at standstill and
/// its back EMF is a part of w4:
///   w0 = (M_r / 12 + M_p) L_r^2   w1 = M_p L_p^2 / 4     w2 = M_p L_p L_r / 2
///   w3 = M_p L_p g / 2            w4 = k_m^2 / R_m + D_r   w5 = D_p.
///
/// Beyond the paper, all without effect at nominal, the torque on the arm is
///   tau = gamma u - coulomb_friction tanh(theta_dot / 0.3 rad/s)
///         - cable_stiffness (theta - cable_rest_angle)
/// and the voltage u [V] that the motor feels during step t is made of the recorded voltages v:
///   delay      u = (1 - f) v[t - k] + f v[t - k - 1], k + f = action_delay [steps], 0 <= f < 1,
///              where the first sample stands for all before it,
///   saturation u is clipped to +-4.5 V,
///   dead zone  u = 0 where voltage_dead_zone_neg <= u <= voltage_dead_zone_pos.
/// u is held over the step. The delay reaches back over the whole recording, also across the
/// borders of segments, since the device had felt those actions.
///
/// Parameters: the nine of Table A5 in its order, then the six above; names, units, nominal values
/// and limits are in info(). State: theta, alpha, theta_dot, alpha_dot. dt = 0.004 s, 1250 steps.
#pragma once

#include "core/random.h"
#include "sim/ode_model.h"

namespace npdr::sim {

/// [s/rad] of the tanh that smooths the sign of theta_dot in dry friction.
inline constexpr double kCoulombSlope = 1.0 / 0.3;

/// [V] The amplifier can't give more.
inline constexpr double kMaxVoltage = 4.5;

class Furuta final : public OdeModel {
 public:
  /// Channels of the state.
  enum State : Index { kTheta, kAlpha, kThetaDot, kAlphaDot };

  Furuta();

  const SimulatorInfo& info() const override { return info_; }
  Index num_constants() const override;
  void prepare(ConstLanes theta, Lanes constants) const override;
  void apply_action(const ActionSeries& actions, Index t, ConstLanes constants,
                    Lanes applied) const override;
  void rhs(ConstLanes constants, ConstLanes applied, ConstLanes y, Lanes ydot) const override;

  /// A voltage of four sines of random frequency (1 to 5 Hz) and phase, 1 V each, faded in over 1 s
  /// (furuta_behavior.cpp says why), from an initial_state(). Both are functions of (seed,
  /// rollout).
  Excitation excite(Index rollout, std::uint64_t seed) const override;

  /// An initial state uniform within +-(2 deg, 1 deg, 0.5 deg/s, 0.5 deg/s).
  static Vector initial_state(Stream& stream);

  /// furuta_regression.h
  std::unique_ptr<RegressionForm> regression_form() const override;

  /// furuta_swing_up.h
  std::unique_ptr<ControlTask> control_task(const Vector& model) const override;

 private:
  SimulatorInfo info_;
};

}  // namespace npdr::sim
