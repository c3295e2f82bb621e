/// The mini golf course: bounds, two obstacles, the hole, the ball and what they are made of.
///
/// Lengths in m, masses in kg, angles in rad; x points from the robot down the course, z up, the
/// ground is z = 0. Parameters are those of Table A4 in its order, then those that it holds fixed.
#pragma once

#include <array>
#include <vector>

#include "core/types.h"
#include "sim/parameter.h"

namespace npdr::sim {

/// A box on the ground: half extents, center and rotation about z.
struct CourseBox {
  double half_x, half_y, half_z;
  double x, y, yaw;
};

/// Properties of a body's surface. Two bodies in contact combine theirs as Bullet does: the
/// products of frictions mu and of restitutions e, and for rolling friction [m] the sum
///   mu_roll,a mu_b + mu_roll,b mu_a.
/// Rolling friction is a torque of at most mu_roll F_n against the rolling, so mu_roll is a length:
/// a sphere of radius r on a plane decelerates by (5/7) g mu_roll / r. Appendix F gives it so,
/// "after multiplication by the local curvature" 1 / r.
struct Surface {
  double friction = 0.0;
  double rolling_friction = 0.0;
  double restitution = 0.0;
};

/// The course and the ball at one theta.
struct Course {
  double ball_radius = 0.0;
  double ball_mass = 0.0;
  Surface ball;
  Surface ground;
  std::array<CourseBox, 2> obstacles{};  ///< left, right
};

inline constexpr Surface kFixtures = {0.8, 0.0, 1.0};  ///< bounds, obstacles and the club
inline constexpr Surface kHoleSurface = {10.0, 10.0, 0.0};
inline constexpr double kGravity = 9.81;       // [m/s^2]
inline constexpr double kNominalMass = 0.005;  // [kg] of the ball
inline constexpr double kHoleRadius = 0.025;
inline constexpr double kHoleX = 1.18977, kHoleY = 1.37017;
inline constexpr double kGroundX = 0.5, kGroundY = 1.3, kGroundHalf = 2.5;  ///< a square
inline constexpr double kBallStartX = 0.304096, kBallStartY = 1.29785;

/// The three bounds around the ground.
const std::array<CourseBox, 3>& bounds();

/// Parameters in the order of theta, with nominal values and limits.
std::vector<Parameter> course_parameters();

/// theta (P), in the order of course_parameters(). Obstacle 1 is the left one, 2 the right one;
/// their offsets count from the nominal poses.
Course course_at(const Eigen::Ref<const Eigen::RowVectorXd>& theta);

/// Corners of a box's footprint, (4, 2), and points around the hole, (k, 2).
RowMatrix corners(const CourseBox& box);
RowMatrix hole_rim();

/// A box seen from above.
class Footprint {
 public:
  explicit Footprint(const CourseBox& box);

  /// From the nearest point of the box to (x, y); 0 inside.
  Eigen::Vector2d outward(double x, double y) const;
  double distance(double x, double y) const { return outward(x, y).norm(); }

 private:
  double x_, y_, cos_, sin_, half_x_, half_y_;
};

/// Whether the ball at (x, y) would begin inside an obstacle or a bound.
bool begins_inside(const Course& course, double x, double y);

/// Whether (x, y) is on the ground, which reaches beyond the open end of the course: a ball that
/// bounces back may roll there for a while.
bool is_on_ground(double x, double y);

}  // namespace npdr::sim
