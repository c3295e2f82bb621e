/// The target domain: H rollouts whose motion the inference explains.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"

namespace npdr {

/// A quantity that a trajectory or an action has one column of.
struct Channel {
  std::string label;  ///< such as "theta_dot"
  std::string unit;   ///< SI, such as "rad/s"
  friend bool operator==(const Channel&, const Channel&) = default;
};

/// A place in state space that rollouts should come to rest at.
struct Goal {
  std::string description;      ///< such as "rests within 5 cm of the hole"
  std::vector<Index> channels;  ///< state channels that count
  Vector place;                 ///< value of each of them, SI
  double radius = 0.0;          ///< Euclidean, SI
  double speed = 0.0;           ///< largest, over the last step: SI per second
};

/// One rollout: states before each action and after the last, and what was applied in between.
struct Rollout {
  std::string name;
  RowMatrix states;   ///< (T + 1, C)
  RowMatrix actions;  ///< (T, A), held over a step
  Index number = 0;   ///< of a simulated truth: among all that it does, held-out ones too, from 0

  Index num_steps() const { return actions.rows(); }
};

/// H rollouts of the target domain, recorded on a device or simulated at a known truth.
/// All rollouts have the same T, C and A.
struct Target {
  double dt = 0.0;  ///< [s] between two states
  std::vector<Channel> state_channels;
  std::vector<Channel> action_channels;
  std::vector<Rollout> rollouts;
  std::string source;  ///< where the rollouts come from, for people

  Index num_rollouts() const { return static_cast<Index>(rollouts.size()); }
  Index num_steps() const { return rollouts.empty() ? 0 : rollouts.front().num_steps(); }
  Index num_states() const { return static_cast<Index>(state_channels.size()); }
  Index num_actions() const { return static_cast<Index>(action_channels.size()); }

  /// Throws InputError unless shapes agree, every value is finite, dt > 0 and there is at least one
  /// rollout with at least one step. `where` (a file name) begins the message.
  void check(const std::string& where) const;

  /// The first `count` rollouts, and those after them. Throws InputError when that leaves none.
  Target first(Index count) const;
  Target after(Index count) const;
  /// The rollouts at some positions, counted from 0, in that order. Throws InputError when there is
  /// none, or no such rollout.
  Target pick(const std::vector<Index>& positions) const;
};

}  // namespace npdr
