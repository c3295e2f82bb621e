#include "sim/furuta.h"

#include <algorithm>
#include <cmath>

#include "sim/lane_math.h"

namespace npdr::sim {
namespace {

enum Param : Index {
  kRotaryDamping,
  kPoleDamping,
  kMotorResistance,
  kMotorConstant,
  kRotaryMass,
  kPoleMass,
  kRotaryLength,
  kPoleLength,
  kGravity,
  kVoltageDeadZoneNeg,
  kVoltageDeadZonePos,
  kActionDelay,
  kCoulombFriction,
  kCableStiffness,
  kCableRestAngle,
};
enum Constant : Index {
  kW0,
  kW1,
  kW2,
  kW3,
  kW4,
  kW5,
  kGamma,
  kCoulomb,
  kCable,
  kCableTorqueAtZero,
  kDeadZoneNeg,
  kDeadZonePos,
  kDelay,
  kNumConstants
};

std::vector<Parameter> furuta_parameters() {
  return {
      {"rotary_damping", "N m s/rad", 5e-6, 0.0, 0.1, "viscous friction D_r of the arm"},
      {"pole_damping", "N m s/rad", 1e-6, 0.0, 0.1, "viscous friction D_p of the pole"},
      {"motor_resistance", "Ohm", 8.4, 1e-2, 1e3, "terminal resistance R_m of the motor"},
      {"motor_constant", "V s/rad", 0.042, 0.0, 10.0, "torque and back-EMF constant k_m"},
      {"rotary_mass", "kg", 0.095, 1e-4, 10.0, "mass M_r of the arm"},
      {"pole_mass", "kg", 0.024, 1e-4, 10.0, "mass M_p of the pole"},
      {"rotary_length", "m", 0.085, 1e-3, 10.0, "length L_r of the arm"},
      {"pole_length", "m", 0.129, 1e-3, 10.0, "length L_p of the pole"},
      {"gravity", "m/s^2", 9.81, 0.0, 30.0, "gravitational acceleration g"},
      {"voltage_dead_zone_neg", "V", 0.0, -kMaxVoltage, 0.0, "negative voltages above it give 0"},
      {"voltage_dead_zone_pos", "V", 0.0, 0.0, kMaxVoltage, "positive voltages below it give 0"},
      {"action_delay", "steps", 0.0, 0.0, 250.0, "time until a voltage acts"},
      {"coulomb_friction", "N m", 0.0, 0.0, 1.0, "dry friction of the arm"},
      {"cable_stiffness", "N m/rad", 0.0, 0.0, 10.0, "pull of the encoder cable on the arm"},
      {"cable_rest_angle", "rad", 0.0, -3.2, 3.2, "arm angle at which the cable is slack"},
  };
}

SimulatorInfo furuta_info() {
  SimulatorInfo info;
  info.name = "furuta";
  info.description = "rotary inverted pendulum driven by a motor voltage (Appendix B)";
  info.parameters = furuta_parameters();
  info.state_channels = {
      {"theta", "rad"}, {"alpha", "rad"}, {"theta_dot", "rad/s"}, {"alpha_dot", "rad/s"}};
  info.action_channels = {{"voltage", "V"}};
  info.dt = 1.0 / 250.0;
  info.num_steps = 1250;
  return info;
}

}  // namespace

Furuta::Furuta() : info_(furuta_info()) {}

Index Furuta::num_constants() const { return kNumConstants; }

void Furuta::prepare(ConstLanes theta, Lanes constants) const {
  const auto p = [&](Param q) { return theta.row(q); };
  const auto c = [&](Constant q) { return constants.row(q); };
  for_each_lane(theta.lanes, [&](Index i) {
    const double pole_moment = 0.5 * p(kPoleMass)[i] * p(kPoleLength)[i];
    const double arm_length = p(kRotaryLength)[i];
    const double motor_constant = p(kMotorConstant)[i];
    c(kW0)[i] = (p(kRotaryMass)[i] / 12.0 + p(kPoleMass)[i]) * arm_length * arm_length;
    c(kW1)[i] = 0.5 * pole_moment * p(kPoleLength)[i];
    c(kW2)[i] = pole_moment * arm_length;
    c(kW3)[i] = pole_moment * p(kGravity)[i];
    c(kGamma)[i] = motor_constant / p(kMotorResistance)[i];
    c(kW4)[i] = motor_constant * motor_constant / p(kMotorResistance)[i] + p(kRotaryDamping)[i];
    c(kW5)[i] = p(kPoleDamping)[i];
    c(kCoulomb)[i] = p(kCoulombFriction)[i];
    c(kCable)[i] = p(kCableStiffness)[i];
    c(kCableTorqueAtZero)[i] = p(kCableStiffness)[i] * p(kCableRestAngle)[i];
    c(kDeadZoneNeg)[i] = p(kVoltageDeadZoneNeg)[i];
    c(kDeadZonePos)[i] = p(kVoltageDeadZonePos)[i];
    c(kDelay)[i] = p(kActionDelay)[i];
  });
}

void Furuta::apply_action(const ActionSeries& actions, Index t, ConstLanes constants,
                          Lanes applied) const {
  const double* const delays = constants.row(kDelay);
  const double* const neg = constants.row(kDeadZoneNeg);
  const double* const pos = constants.row(kDeadZonePos);
  double* const voltage = applied.row(0);
  const auto longest = static_cast<double>(t);
  for_each_lane(applied.lanes, [&](Index i) {
    // Written so that no delay, not even NaN or a negative one, indexes out of the recording.
    const double delay = delays[i] > 0.0 ? (delays[i] < longest ? delays[i] : longest) : 0.0;
    const auto whole = static_cast<Index>(delay);
    const Index newer = t - whole;
    const Index older = newer > 0 ? newer - 1 : 0;
    const double fraction = delay - static_cast<double>(whole);
    const double last = actions.at(newer, 0, i), before = actions.at(older, 0, i);
    const double blend = last + fraction * (before - last);
    const double clipped =
        blend < kMaxVoltage ? (blend > -kMaxVoltage ? blend : -kMaxVoltage) : kMaxVoltage;
    voltage[i] = ((neg[i] <= clipped) & (clipped <= pos[i])) ? 0.0 : clipped;
  });
}

void Furuta::rhs(ConstLanes constants, ConstLanes applied, ConstLanes y, Lanes ydot) const {
  const auto c = [&](Constant q) { return constants.row(q); };
  const double *const w0 = c(kW0), *const w1 = c(kW1), *const w2 = c(kW2), *const w3 = c(kW3),
                      *const w4 = c(kW4), *const w5 = c(kW5), *const gamma = c(kGamma),
                      *const coulomb = c(kCoulomb), *const cable = c(kCable),
                      *const cable_torque_at_zero = c(kCableTorqueAtZero);
  const double* const voltage = applied.row(0);
  const double *const theta = y.row(kTheta), *const alpha = y.row(kAlpha),
                      *const theta_dot = y.row(kThetaDot), *const alpha_dot = y.row(kAlphaDot);
  double *const theta_rate = ydot.row(kTheta), *const alpha_rate = ydot.row(kAlpha),
                *const theta_ddot = ydot.row(kThetaDot), *const alpha_ddot = ydot.row(kAlphaDot);
  for_each_lane(y.lanes, [&](Index i) {
    const double arm_rate = theta_dot[i], pole_rate = alpha_dot[i];
    const auto [sin_alpha, cos_alpha] = lane_sincos(alpha[i]);
    const double tau = gamma[i] * voltage[i] - coulomb[i] * lane_tanh(kCoulombSlope * arm_rate) -
                       (cable[i] * theta[i] - cable_torque_at_zero[i]);
    const double w1_sin_2alpha = 2.0 * w1[i] * sin_alpha * cos_alpha;
    const double m11 = w0[i] + w1[i] * sin_alpha * sin_alpha;
    const double m12 = w2[i] * cos_alpha;
    const double m22 = 4.0 / 3.0 * w1[i];
    const double c1 = w1_sin_2alpha * arm_rate * pole_rate -
                      w2[i] * sin_alpha * pole_rate * pole_rate + w4[i] * arm_rate;
    const double c2 =
        -0.5 * w1_sin_2alpha * arm_rate * arm_rate + w3[i] * sin_alpha + w5[i] * pole_rate;
    // q_ddot = M^-1 (tau - c_1, -c_2)
    const double scale = 1.0 / (m11 * m22 - m12 * m12);
    theta_rate[i] = arm_rate;
    alpha_rate[i] = pole_rate;
    theta_ddot[i] = scale * (m22 * (tau - c1) + m12 * c2);
    alpha_ddot[i] = scale * (-m11 * c2 - m12 * (tau - c1));
  });
}

}  // namespace npdr::sim
