/// Mini golf (Section 4.2 and Appendix F of the paper): a robot arm strikes a ball, which rolls
/// along a course with two obstacles and a hole. Bullet simulates the ball, rigid-body contact and
/// friction included; the arm follows its joint angles exactly (arm.h, course.h, ball_world.h).
///
/// Parameters: the ten of Table A4 in its order, then friction and restitution of ball and ground;
/// names, units, nominal values and limits are in info(). State: ball_x, ball_y [m]. Actions: joint
/// angles q1_cmd to q7_cmd [rad], between which the joints move on straight lines. dt = 0.01 s, 800
/// steps.
///
/// Status: a ball that would begin inside an obstacle, a bound or the club is out_of_limits; one
/// that leaves the ground or sinks into the ground left_scene; NaN diverged. A ball that has come
/// to rest, and that the club won't reach any more, isn't simulated further: its last position
/// fills the rest of the rollout.
#pragma once

#include "sim/simulator.h"

namespace npdr::sim {

class Minigolf final : public Simulator {
 public:
  /// Throws InputError for a config that is out of range; names the field, value and constraint.
  explicit Minigolf(const SimulatorConfig& config);

  const SimulatorInfo& info() const override { return info_; }
  Trajectories replay(const Target& target, const RowMatrix& theta) const override;

  /// Table A4's strike. The ball begins within 5 mm of its nominal place in x and in y, uniformly,
  /// as a function of (seed, rollout): recordings differ by as much. With ball_start = "nominal" it
  /// begins there, and all rollouts are the same.
  Target behave(const Vector& theta, Index num_rollouts, std::uint64_t seed) const override;

  /// The bounds and the hole, then the obstacles.
  std::vector<Outline> outlines(const Vector& theta) const override;

 private:
  SimulatorConfig config_;
  SimulatorInfo info_;  // with the config's parameters as nominal values
};

}  // namespace npdr::sim
