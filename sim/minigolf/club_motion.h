/// Motion of the club's head during a rollout, worked out once for all simulations of it.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/types.h"

namespace npdr::sim {

/// Distance [m] of `point` from the surface of a head with that pose; negative inside.
double head_gap(const Eigen::Isometry3d& head, const Eigen::Vector3d& point);

/// The joints move on straight lines between the actions of a rollout: during step t from those of
/// action t to those of action t + 1, and rest at the last action.
class ClubMotion {
 public:
  /// `actions` (T, 7) are joint angles [rad]. Poses are kept for T steps of `coarse` and of `fine`
  /// substeps.
  ClubMotion(const RowMatrix& actions, Index coarse, Index fine);

  Index num_steps() const { return static_cast<Index>(during_.size()); }
  Index num_substeps(bool is_fine) const { return is_fine ? fine_ : coarse_; }

  /// Pose of the head at the end of substep k (0 to n - 1) of step t, where the step has n = `fine`
  /// or n = `coarse` substeps; k = -1 is the beginning of the step.
  const Eigen::Isometry3d& pose(Index t, Index k, bool is_fine) const;

  /// A lower bound of the distance of `point` from the head during step t, and from step t on.
  double clearance(Index t, const Eigen::Vector3d& point) const;
  double clearance_from(Index t, const Eigen::Vector3d& point) const;

 private:
  Index coarse_, fine_;
  std::vector<Eigen::Isometry3d> coarse_poses_, fine_poses_;  // (T n + 1)
  std::vector<Eigen::AlignedBox3d> during_, from_;            // of the head's center
  std::vector<double> motion_;  // [m] of any point of the head between two fine poses, at most
};

}  // namespace npdr::sim
