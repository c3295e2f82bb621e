#include "sim/pendulum.h"

#include <cmath>
#include <numbers>

#include "sim/lane_math.h"

namespace npdr::sim {
namespace {

enum Param : Index { kPoleMass, kPoleLength, kGravity, kDamping };
enum State : Index { kTheta, kThetaDot };
// theta_ddot = torque_gain tau - gravity_gain sin(theta) - damping_gain theta_dot
enum Constant : Index { kTorqueGain, kGravityGain, kDampingGain, kNumConstants };

SimulatorInfo pendulum_info() {
  SimulatorInfo info;
  info.name = "pendulum";
  info.description = "rigid rod on a rotational joint, driven by a torque (Appendix A)";
  info.parameters = {
      {"pole_mass", "kg", 1.0, 1e-3, 100.0, "mass m_p of the rod"},
      {"pole_length", "m", 1.0, 1e-2, 100.0, "length l_p of the rod"},
      {"gravity", "m/s^2", 9.81, 0.0, 30.0, "gravitational acceleration g"},
      {"damping", "N m s/rad", 0.0, 0.0, 100.0, "viscous friction d_p of the joint"},
  };
  info.state_channels = {{"theta", "rad"}, {"theta_dot", "rad/s"}};
  info.action_channels = {{"torque", "N m"}};
  info.dt = 1.0 / 50.0;
  info.num_steps = 400;
  return info;
}

}  // namespace

Pendulum::Pendulum() : info_(pendulum_info()) {}

Index Pendulum::num_constants() const { return kNumConstants; }

void Pendulum::prepare(ConstLanes theta, Lanes constants) const {
  const double* const mass = theta.row(kPoleMass);
  const double* const length = theta.row(kPoleLength);
  const double* const gravity = theta.row(kGravity);
  const double* const damping = theta.row(kDamping);
  double* const torque_gain = constants.row(kTorqueGain);
  double* const gravity_gain = constants.row(kGravityGain);
  double* const damping_gain = constants.row(kDampingGain);
  for_each_lane(theta.lanes, [&](Index i) {
    const double inertia = mass[i] * length[i] * length[i] / 3.0;
    torque_gain[i] = 1.0 / inertia;
    gravity_gain[i] = 0.5 * mass[i] * gravity[i] * length[i] / inertia;
    damping_gain[i] = damping[i] / inertia;
  });
}

void Pendulum::rhs(ConstLanes constants, ConstLanes applied, ConstLanes y, Lanes ydot) const {
  const double* const torque_gain = constants.row(kTorqueGain);
  const double* const gravity_gain = constants.row(kGravityGain);
  const double* const damping_gain = constants.row(kDampingGain);
  const double* const torque = applied.row(0);
  const double* const theta = y.row(kTheta);
  const double* const theta_dot = y.row(kThetaDot);
  double* const velocity = ydot.row(kTheta);
  double* const acceleration = ydot.row(kThetaDot);
  for_each_lane(y.lanes, [&](Index i) {
    velocity[i] = theta_dot[i];
    acceleration[i] = torque_gain[i] * torque[i] - gravity_gain[i] * lane_sincos(theta[i]).sin -
                      damping_gain[i] * theta_dot[i];
  });
}

Excitation Pendulum::excite(Index /*rollout*/, std::uint64_t /*seed*/) const {
  Excitation excitation{Vector::Zero(2), RowMatrix(info_.num_steps, 1)};
  for (Index t = 0; t < info_.num_steps; ++t) {
    const double time = static_cast<double>(t) * info_.dt;
    excitation.actions(t, 0) = 4.5 * std::sin(2.0 * std::numbers::pi * time);
  }
  return excitation;
}

}  // namespace npdr::sim
