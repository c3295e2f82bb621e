/// The pieces of a target's rollouts that a simulator of the user's replays one by one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/target.h"
#include "core/types.h"
#include "sim/trajectories.h"

namespace npdr::sim {

/// S segments of H rollouts, one after the other, with N steps in all. A segment begins in a
/// recorded state, and ends where the next one begins.
struct Segments {
  double dt = 0.0;                  ///< [s]
  Index num_rollouts = 0;           ///< H
  std::vector<std::int64_t> steps;  ///< (S)
  std::vector<std::int64_t> past;   ///< (S) steps of the same rollout before the segment's first
  RowMatrix first_states;           ///< (S, C)
  RowMatrix actions;                ///< (N, A)

  Index num_segments() const { return static_cast<Index>(steps.size()); }
  Index num_steps() const { return actions.rows(); }
  Index num_states() const { return first_states.cols(); }
};

/// Cuts every rollout after each `segment_length` steps; 0: never.
Segments cut(const Target& target, Index segment_length);

/// Keeps every `store_every`-th of the states (N, C) that a row has made of the segments, as row i
/// of `result`. A state that isn't finite, or that a float doesn't hold, makes the row diverged.
void store_states(const Segments& segments, const double* states, Index store_every, Index i,
                  Trajectories& result);

/// Rows of `segments` that nobody has simulated yet: (n, H, T / store_every, C).
Trajectories empty_trajectories(const Segments& segments, Index num_rows, Index store_every);

/// Makes row i NaN, with the status.
void lose_row(Index i, RolloutStatus status, Trajectories& result);

}  // namespace npdr::sim
