#include "sim/minigolf/club_motion.h"

#include <algorithm>

#include "core/constants.h"
#include "sim/minigolf/arm.h"
#include "sim/minigolf/head.h"

namespace npdr::sim {
namespace {

JointAngles joints(const RowMatrix& actions, Index t) {
  JointAngles q;
  std::copy_n(actions.row(t).data(), q.size(), q.begin());
  return q;
}

std::vector<Eigen::Isometry3d> poses(const RowMatrix& actions, Index substeps) {
  const Index last = actions.rows() - 1;
  std::vector<Eigen::Isometry3d> result;
  result.reserve(static_cast<std::size_t>(actions.rows() * substeps + 1));
  for (Index i = 0; i <= actions.rows() * substeps; ++i) {
    const Index t = std::min(i / substeps, last);
    const double fraction = static_cast<double>(i % substeps) / static_cast<double>(substeps);
    result.push_back(
        head_pose(between(joints(actions, t), joints(actions, std::min(t + 1, last)), fraction)));
  }
  return result;
}

// How far any point of the head moves from one pose to another, at most.
double largest_motion(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  const Eigen::AngleAxisd turn(from.linear().transpose() * to.linear());
  return (to.translation() - from.translation()).norm() +
         std::abs(turn.angle()) * kHeadBoundingRadius;
}

}  // namespace

double head_gap(const Eigen::Isometry3d& head, const Eigen::Vector3d& point) {
  const Eigen::Vector3d local = head.inverse() * point;
  const Eigen::Vector3d nearest(std::clamp(local.x(), -kHeadHalfX, kHeadHalfX),
                                std::clamp(local.y(), -kHeadHalfY, kHeadHalfY), 0.0);
  return (local - nearest).norm() - kHeadRadius;
}

ClubMotion::ClubMotion(const RowMatrix& actions, Index coarse, Index fine)
    : coarse_(coarse),
      fine_(fine),
      coarse_poses_(poses(actions, coarse)),
      fine_poses_(poses(actions, fine)) {
  for (Index t = 0; t < actions.rows(); ++t) {
    Eigen::AlignedBox3d box(pose(t, -1, true).translation());
    double motion = 0.0;
    for (Index k = 0; k < fine_; ++k) {
      box.extend(pose(t, k, true).translation());
      motion = std::max(motion, largest_motion(pose(t, k - 1, true), pose(t, k, true)));
    }
    during_.push_back(box);
    motion_.push_back(motion);
  }
  from_ = during_;
  for (std::size_t t = from_.size() - 1; t-- > 0;) from_[t].extend(from_[t + 1]);
}

const Eigen::Isometry3d& ClubMotion::pose(Index t, Index k, bool is_fine) const {
  const Index i = t * (is_fine ? fine_ : coarse_) + k + 1;
  return (is_fine ? fine_poses_ : coarse_poses_)[static_cast<std::size_t>(i)];
}

// Between two poses the head is no farther from the next one than half of what it moves.
double ClubMotion::clearance(Index t, const Eigen::Vector3d& point) const {
  const auto step = static_cast<std::size_t>(t);
  const double bound = during_[step].exteriorDistance(point) - kHeadBoundingRadius;
  if (bound > kHeadBoundingRadius) return bound;
  double nearest = kInfinity;
  for (Index k = -1; k < fine_; ++k) nearest = std::min(nearest, head_gap(pose(t, k, true), point));
  return std::max(bound, nearest - 0.5 * motion_[step]);
}

double ClubMotion::clearance_from(Index t, const Eigen::Vector3d& point) const {
  return from_[static_cast<std::size_t>(t)].exteriorDistance(point) - kHeadBoundingRadius;
}

}  // namespace npdr::sim
