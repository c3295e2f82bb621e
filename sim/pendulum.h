/// The pendulum of the paper's Section 4.1 and Appendix A: a rigid rod on a rotational joint.
///
///   theta_ddot = (tau - m_p g l_p sin(theta) / 2 - d_p theta_dot) / (m_p l_p^2 / 3)
///
/// theta [rad] is 0 when the rod hangs down; tau [N m] is the torque at the joint, held over a
/// step. The appendix names the viscous damping d_p but leaves its term out; it is 0 at nominal.
/// Parameters, in this order: pole_mass m_p [kg], pole_length l_p [m], gravity g [m/s^2], damping
/// d_p [N m s/rad]. State: theta, theta_dot. dt = 1/50 s, 400 steps.
#pragma once

#include "sim/ode_model.h"

namespace npdr::sim {

class Pendulum final : public OdeModel {
 public:
  Pendulum();

  const SimulatorInfo& info() const override { return info_; }
  Index num_constants() const override;
  void prepare(ConstLanes theta, Lanes constants) const override;
  void rhs(ConstLanes constants, ConstLanes applied, ConstLanes y, Lanes ydot) const override;

  /// tau(t) = 4.5 sin(2 pi t) N m (Table A3) from the zero state: the same in every rollout.
  Excitation excite(Index rollout, std::uint64_t seed) const override;

 private:
  SimulatorInfo info_;
};

}  // namespace npdr::sim
