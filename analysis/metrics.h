/// Fit of simulated rollouts to the recorded ones: RMSE and DTW distance (Tables 2 and A2).
///
/// The simulator restarts from the recorded state every segment_length steps, and a simulated
/// rollout is the concatenation of its segments. Compared are the states before each action, t = 0,
/// ..., T - 1: where a segment starts, both are the recorded state (as in the published figures).
/// Per rollout, both trajectories are divided by the recorded rollout's maximum absolute value,
/// channel by channel. With e = simulated - recorded after that,
///   rmse = mean_c sqrt( mean_t e(t, c)^2 )
///   dtw  = accumulated cost of the open-end warping path of analysis/dtw.h
/// both averaged over the H rollouts. Both are dimensionless. For what matters is where a rollout
/// ends, with y_T the state after the last action, not divided by anything:
///   final_error = || y_T simulated - y_T recorded ||_2 over the channels, averaged over rollouts
///   goal        = fraction of the rollouts whose y_T is within the goal's radius of its place,
///                 and | y_T - y_{T-1} | / dt is at most its speed.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/trajectory_view.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::analysis {

struct MetricsConfig {
  std::vector<Index> channels = {};  ///< state channels that count; empty: all of them
  Index segment_length = 0;          ///< [steps] between restarts; 0: none
};

/// The recorded rollouts, normalized once, and what simulated ones are measured by against them.
/// Const calls are thread-safe and parallel over samples, with the same bits on any number of
/// threads. A sample with a value that isn't finite gets NaN: the rollout failed.
class Metrics {
 public:
  /// `target` has passed its check().
  /// Throws InputError for a channel that doesn't exist or is listed twice, a negative
  /// segment_length, and a channel that is 0 throughout a recorded rollout: nothing can be
  /// normalized by it; name the other channels in `channels`.
  explicit Metrics(const Target& target, const MetricsConfig& config = {});

  /// (n) normalized root mean square errors. Throws ShapeError when `simulated` has another number
  /// of rollouts, steps or states than the target.
  Vector rmse(const TrajectoryView& simulated) const;

  /// (n) dynamic time warping distances; about 0.3 ns n H T^2 on one core. Throws as rmse() does.
  Vector dtw(const TrajectoryView& simulated) const;

  /// (n) distances of the last states, in the channels' unit. Throws as rmse() does.
  Vector final_error(const TrajectoryView& simulated) const;

  /// (n) fractions of the H rollouts that reach the goal. Throws as rmse() does.
  Vector goal(const TrajectoryView& simulated, const Goal& goal) const;

 private:
  struct Recorded {
    RowMatrix states;   // (T, selected channels), normalized
    Vector scale;       // (selected channels), SI
    RowMatrix restart;  // (1, C) where the last step begins a segment: its recorded state, SI
    RowMatrix last;     // (1, selected channels) state T, SI
  };

  /// Mean over the rollouts h of score(end, h); NaN where a rollout failed. `end` (2, C) holds the
  /// last two states, SI.
  Vector mean_over_ends(const TrajectoryView& simulated,
                        const std::function<double(const RowMatrix&, Index)>& score) const;
  void check(const TrajectoryView& simulated) const;
  /// The compared states of a simulated rollout, whose row t is the state after action t + 1.
  void normalize_rollout(const Eigen::Ref<const RowMatrixF>& states, Index h,
                         std::span<double> normalized) const;

  std::vector<Index> channels_;
  Index num_states_;
  Index num_steps_;
  Index segment_length_;
  double dt_;
  std::vector<Recorded> recorded_;
};

}  // namespace npdr::analysis
