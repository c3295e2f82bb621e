/// The mini golf robot's arm: seven rotational joints, the last link holds a golf club.
///
/// Forward kinematics: with T(x, y, z; a, b, c) = Trans(x, y, z) Rx(a) Ry(b) Rz(c), the pose of
/// link i is E_i = E_{i-1} T_i Rz(q_i), E_0 = T_base, and the club's is E_7 T_club. All poses are
/// from body to world; lengths in m, angles in rad. Constants: arm.cpp.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "core/types.h"

namespace npdr::sim {

inline constexpr std::size_t kNumJoints = 7;

/// Joint angles q_1, ..., q_7 [rad].
using JointAngles = std::array<double, kNumJoints>;

/// Pose of the club's frame, which begins at its grip.
Eigen::Isometry3d club_pose(const JointAngles& q);

/// Pose of the club's head: a plate in its own x-y plane, which hits the ball along z.
Eigen::Isometry3d head_pose(const JointAngles& q);

/// begin + fraction (end - begin), joint by joint.
JointAngles between(const JointAngles& begin, const JointAngles& end, double fraction);

/// The behavior policy of Table A4: q_init + (q_end - q_init) min(t / 0.5 s, 1).
JointAngles strike(double time);

/// The policy's actions at t dt, t = 0, ..., T - 1: (T, 7).
RowMatrix strike_actions(Index num_steps, double dt);

}  // namespace npdr::sim
