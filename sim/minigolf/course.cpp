#include "sim/minigolf/course.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace npdr::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

// Nominal obstacles: left, right.
constexpr std::array<CourseBox, 2> kObstacles = {{
    {0.29, 0.015, 0.015, 0.9, 1.45, -5.0 * kDegree},
    {0.29, 0.015, 0.015, 0.6, 1.2, 25.0 * kDegree},
}};

enum : std::size_t {
  kRadius,
  kMass,
  kRestitution,
  kRollingFriction,
  kDx1,
  kDy1,
  kDx2,
  kDy2,
  kDyaw1,
  kDyaw2,
  kFriction,
  kGroundFriction,
  kGroundRollingFriction,
  kGroundRestitution,
};

CourseBox moved(CourseBox box, double dx, double dy, double dyaw) {
  box.x += dx;
  box.y += dy;
  box.yaw += dyaw;
  return box;
}

}  // namespace

const std::array<CourseBox, 3>& bounds() {
  static constexpr std::array<CourseBox, 3> boxes = {{
      {0.55, 0.02, 0.02, 0.85, 1.7, 0.0},
      {0.55, 0.02, 0.02, 0.85, 0.9, 0.0},
      {0.42, 0.02, 0.02, 1.42, 1.3, -90.0 * kDegree},
  }};
  return boxes;
}

std::vector<Parameter> course_parameters() {
  return {
      {"ball_radius", "m", 0.02, 0.005, 0.05, "radius of the ball"},
      {"ball_mass", "kg", kNominalMass, 1e-4, 1.0, "mass of the ball"},
      {"ball_restitution", "1", 0.5, 0.0, 1.0, "restitution of the ball"},
      {"ball_rolling_friction", "m", 1e-5, 0.0, 1e-2, "rolling friction of the ball"},
      {"obstacle1_dx", "m", 0.0, -0.3, 0.3, "left obstacle, offset along the course"},
      {"obstacle1_dy", "m", 0.0, -0.3, 0.3, "left obstacle, offset across the course"},
      {"obstacle2_dx", "m", 0.0, -0.3, 0.3, "right obstacle, offset along the course"},
      {"obstacle2_dy", "m", 0.0, -0.3, 0.3, "right obstacle, offset across the course"},
      {"obstacle1_dyaw", "rad", 0.0, -2 * kPi, 2 * kPi, "left obstacle, turn about the vertical",
       kPi},
      {"obstacle2_dyaw", "rad", 0.0, -2 * kPi, 2 * kPi, "right obstacle, turn about the vertical",
       kPi},
      {"ball_friction", "1", 0.6, 0.0, 10.0, "sliding friction of the ball"},
      {"ground_friction", "1", 0.4, 0.0, 10.0, "sliding friction of the ground"},
      {"ground_rolling_friction", "m", 1e-5, 0.0, 1e-2, "rolling friction of the ground"},
      {"ground_restitution", "1", 0.0, 0.0, 1.0, "restitution of the ground"},
  };
}

Course course_at(const Eigen::Ref<const Eigen::RowVectorXd>& theta) {
  const auto at = [&](std::size_t p) { return theta(static_cast<Index>(p)); };
  Course course;
  course.ball_radius = at(kRadius);
  course.ball_mass = at(kMass);
  course.ball = {at(kFriction), at(kRollingFriction), at(kRestitution)};
  course.ground = {at(kGroundFriction), at(kGroundRollingFriction), at(kGroundRestitution)};
  course.obstacles = {moved(kObstacles[0], at(kDx1), at(kDy1), at(kDyaw1)),
                      moved(kObstacles[1], at(kDx2), at(kDy2), at(kDyaw2))};
  return course;
}

RowMatrix corners(const CourseBox& box) {
  RowMatrix points(4, 2);
  const double c = std::cos(box.yaw), s = std::sin(box.yaw);
  for (Index i = 0; i < 4; ++i) {
    const double along = i == 0 || i == 3 ? -box.half_x : box.half_x;
    const double across = i < 2 ? -box.half_y : box.half_y;
    points.row(i) << box.x + c * along - s * across, box.y + s * along + c * across;
  }
  return points;
}

RowMatrix hole_rim() {
  constexpr Index count = 24;
  RowMatrix points(count, 2);
  for (Index i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(count);
    points.row(i) << kHoleX + kHoleRadius * std::cos(angle), kHoleY + kHoleRadius * std::sin(angle);
  }
  return points;
}

Footprint::Footprint(const CourseBox& box)
    : x_(box.x),
      y_(box.y),
      cos_(std::cos(box.yaw)),
      sin_(std::sin(box.yaw)),
      half_x_(box.half_x),
      half_y_(box.half_y) {}

Eigen::Vector2d Footprint::outward(double x, double y) const {
  const double dx = x - x_, dy = y - y_;
  const double u = cos_ * dx + sin_ * dy, v = cos_ * dy - sin_ * dx;
  const double along = u - std::clamp(u, -half_x_, half_x_);
  const double across = v - std::clamp(v, -half_y_, half_y_);
  return {cos_ * along - sin_ * across, sin_ * along + cos_ * across};
}

bool begins_inside(const Course& course, double x, double y) {
  // A ball that is lower than an obstacle's edge touches its side; a higher one, the edge.
  const auto overlaps = [&](const CourseBox& box) {
    const double r = course.ball_radius, above = std::max(r - 2.0 * box.half_z, 0.0);
    return Footprint(box).distance(x, y) < std::sqrt(std::max(r * r - above * above, 0.0));
  };
  return std::ranges::any_of(course.obstacles, overlaps) || std::ranges::any_of(bounds(), overlaps);
}

bool is_on_ground(double x, double y) {
  return std::abs(x - kGroundX) < kGroundHalf && std::abs(y - kGroundY) < kGroundHalf;
}

}  // namespace npdr::sim
