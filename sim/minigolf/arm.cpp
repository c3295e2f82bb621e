#include "sim/minigolf/arm.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace npdr::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStrikeDuration = 0.5;  // [s]

// Trans(x, y, z) Rx(a) Ry(b) Rz(c), lengths in m, angles in degrees.
struct Placement {
  double x, y, z;
  double a = 0.0, b = 0.0, c = 0.0;

  Eigen::Isometry3d pose() const {
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    Eigen::Isometry3d pose(Eigen::Translation3d(x, y, z));
    pose.rotate(AngleAxisd(a * kDegree, Vector3d::UnitX()));
    pose.rotate(AngleAxisd(b * kDegree, Vector3d::UnitY()));
    pose.rotate(AngleAxisd(c * kDegree, Vector3d::UnitZ()));
    return pose;
  }
};

constexpr Placement kBase = {0.0, 0.3075, 1.2, 0.0, 0.0, 90.0};
constexpr std::array<Placement, kNumJoints> kJoints = {{
    {0.0, 0.0, 0.12},
    {0.175, 0.0, 0.0, 0.0, 90.0, 0.0},
    {0.0, 0.0, 0.175, 0.0, -90.0, 0.0},
    {0.1515, 0.0, 0.0, 0.0, 90.0, 0.0},
    {0.0, 0.0, 0.2115, 0.0, -90.0, 0.0},
    {0.12575, 0.0, 0.0, 0.0, 90.0, 0.0},
    {0.0, 0.0, 0.16575, 0.0, -90.0, 0.0},
}};
constexpr Placement kClub = {0.164, -0.02, -0.01, 0.0, 90.0, -165.0};
constexpr Placement kHeadInClub = {0.01, -0.945, 0.0, 0.0, 0.0, 57.0};

JointAngles from_degrees(JointAngles q) {
  for (double& angle : q) angle *= kDegree;
  return q;
}

}  // namespace

Eigen::Isometry3d club_pose(const JointAngles& q) {
  static const Eigen::Isometry3d base = kBase.pose();
  static const Eigen::Isometry3d club = kClub.pose();
  static const auto joints = [] {
    std::array<Eigen::Isometry3d, kNumJoints> poses;
    std::ranges::transform(kJoints, poses.begin(), &Placement::pose);
    return poses;
  }();
  Eigen::Isometry3d pose = base;
  for (std::size_t i = 0; i < kNumJoints; ++i) {
    pose = pose * joints[i] * Eigen::AngleAxisd(q[i], Eigen::Vector3d::UnitZ());
  }
  return pose * club;
}

Eigen::Isometry3d head_pose(const JointAngles& q) {
  static const Eigen::Isometry3d head = kHeadInClub.pose();
  return club_pose(q) * head;
}

JointAngles between(const JointAngles& begin, const JointAngles& end, double fraction) {
  JointAngles q;
  for (std::size_t i = 0; i < kNumJoints; ++i) q[i] = begin[i] + fraction * (end[i] - begin[i]);
  return q;
}

JointAngles strike(double time) {
  static const JointAngles begin = from_degrees(
      {18.996253, -87.227101, 74.149568, -75.577025, 56.207369, -175.162794, -41.543793});
  static const JointAngles end = from_degrees(
      {8.628977, -93.443498, 72.302435, -82.31844, 52.146531, -183.896354, -51.560886});
  return between(begin, end, std::min(time / kStrikeDuration, 1.0));
}

RowMatrix strike_actions(Index num_steps, double dt) {
  RowMatrix actions(num_steps, static_cast<Index>(kNumJoints));
  for (Index t = 0; t < num_steps; ++t) {
    std::ranges::copy(strike(static_cast<double>(t) * dt), actions.row(t).data());
  }
  return actions;
}

}  // namespace npdr::sim
