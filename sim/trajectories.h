/// Results of a simulator: the simulated counterparts of the target's rollouts.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace npdr::sim {

/// End of the rollouts of one row (one theta). A failed row is data: it keeps its place.
enum class RolloutStatus : std::uint8_t {
  ok = 0,
  diverged = 1,       ///< a state became NaN or infinite
  out_of_limits = 2,  ///< parameters that are physically impossible
  left_scene = 3,     ///< a body left the part of the world that the simulator knows
  crashed = 4,        ///< the program that simulates it failed
  timed_out = 5,      ///< the program was ended after its time limit
  bad_output = 6,     ///< the program wrote what isn't a row of numbers
};

/// "ok", "diverged", "out_of_limits", "left_scene", "crashed", "timed_out", "bad_output".
std::string_view to_string(RolloutStatus status);

/// Trajectories of n rows: row i holds H rollouts of T stored states of C channels, row-major,
/// (n, H, T, C). A row whose status isn't ok holds NaN throughout.
struct Trajectories {
  Index num_rows = 0;
  Index num_rollouts = 0;
  Index num_steps = 0;  ///< stored states per rollout: floor(target steps / store_every)
  Index num_states = 0;
  std::vector<float> values;
  std::vector<RolloutStatus> status;  ///< (n)

  void resize(Index rows, Index rollouts, Index steps, Index states);
  /// Adds rows of rollouts of the same size, or of any size where there are none yet.
  void append(const Trajectories& rows);
  bool is_ok(Index i) const { return status[static_cast<std::size_t>(i)] == RolloutStatus::ok; }
  Index row_size() const { return num_rollouts * num_steps * num_states; }
  std::span<float> row(Index i);
  std::span<const float> row(Index i) const;
  /// Rollout h of row i as a (T, C) view.
  Eigen::Map<const RowMatrixF> rollout(Index i, Index h) const;
};

}  // namespace npdr::sim
