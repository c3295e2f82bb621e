/// Simulated rollouts as they come from a simulator or a file, without a copy.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace npdr::analysis {

/// Simulated rollouts of n parameter samples: (n, H, T, C) row-major, states 1 to T of each.
struct TrajectoryView {
  std::span<const float> values;
  Index num_samples = 0;
  Index num_rollouts = 0;
  Index num_steps = 0;
  Index num_states = 0;

  Index row_size() const { return num_rollouts * num_steps * num_states; }
  /// Rollout h of sample i as a (T, C) view.
  Eigen::Map<const RowMatrixF> rollout(Index i, Index h) const;
  /// True when every value of sample i is finite, in every channel.
  bool finite(Index i) const;
  /// Samples whose values are all finite, in ascending order.
  std::vector<Index> finite_samples() const;
  /// Throws ShapeError unless the counts multiply to the number of values.
  void check() const;
};

}  // namespace npdr::analysis
