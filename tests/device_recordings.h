/// Recordings as of devices: simulations that have what the model under test lacks.
#pragma once

#include <map>
#include <string>

#include "core/random.h"
#include "sim/simulator.h"

namespace npdr {

/// Adds white noise with these standard deviations, one a channel and in its unit, to all states.
inline void add_noise(Target& target, const Vector& deviations) {
  Stream stream({1, "device noise", 0, 0, 0});
  for (Rollout& rollout : target.rollouts) {
    for (Index t = 0; t < rollout.states.rows(); ++t) {
      for (Index c = 0; c < rollout.states.cols(); ++c) {
        rollout.states(t, c) += deviations(c) * stream.normal();
      }
    }
  }
}

/// Rollouts of a Furuta pendulum with nominal masses and lengths whose motor feels a voltage late
/// and not near zero, whose arm rubs and pulls at a cable, and whose encoders are noisy.
inline Target furuta_recording(Index num_rollouts) {
  const auto device = sim::make_simulator({.name = "furuta"});
  const Vector theta = sim::complete_theta(*device, {{"action_delay", 1.5},
                                                     {"voltage_dead_zone_neg", -0.1},
                                                     {"voltage_dead_zone_pos", 0.2},
                                                     {"coulomb_friction", 5e-4},
                                                     {"cable_stiffness", 1e-3}});
  Target target = device->behave(theta, num_rollouts, 1);
  target.source = "a simulated Furuta pendulum";
  add_noise(target, Eigen::Vector4d(2e-3, 2e-3, 0.3, 0.3));
  return target;
}

/// Parameters of a mini golf whose ball rolls less far and whose obstacles stand elsewhere.
inline const std::map<std::string, double> kGolfDevice = {
    {"ball_rolling_friction", 2e-4}, {"ball_restitution", 0.7}, {"obstacle2_dyaw", 0.1}};

/// Its strikes.
inline Target minigolf_recording(Index num_rollouts) {
  const auto device = sim::make_simulator({.name = "minigolf"});
  Target target = device->behave(sim::complete_theta(*device, kGolfDevice), num_rollouts, 1);
  target.source = "a simulated mini golf";
  return target;
}

}  // namespace npdr
