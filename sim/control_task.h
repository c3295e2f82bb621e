/// A policy and what is asked of it, vectorized over lanes: the closed loop's counterpart of
/// OdeModel.
///
/// Arrays are (quantity, lanes), see sim/lanes.h: policies (Q, lanes), states y (S, lanes),
/// commanded actions (A, lanes); flags (lanes) are 1 or 0. All members are const and thread-safe;
/// all arrays belong to the caller.
#pragma once

#include "core/random.h"
#include "core/types.h"
#include "sim/lanes.h"
#include "sim/policy_task.h"

namespace npdr::sim {

class ControlTask {
 public:
  virtual ~ControlTask() = default;

  /// dt and num_steps are those of the model.
  virtual const PolicyTaskInfo& info() const = 0;

  /// Actions are clipped to +- this, in the unit of the action channels.
  virtual double action_limit() const = 0;

  /// The last [steps] that success looks at.
  virtual Index hold_steps() const = 0;

  /// Commanded actions, before they are clipped.
  virtual void act(ConstLanes policies, ConstLanes y, Lanes commanded) const = 0;

  /// Rewards (lanes) in [0, 1] of a state and the action that is commanded in it.
  virtual void reward(ConstLanes y, ConstLanes commanded, double* rewards) const = 0;

  /// Whether the state is within the task's limits; a state that isn't finite isn't.
  virtual void within_limits(ConstLanes y, double* flags) const = 0;

  /// Whether the state is one that a success has throughout its last hold_steps() states.
  virtual void is_held(ConstLanes y, double* flags) const = 0;

  /// A random initial state, (S).
  virtual Vector initial_state(Stream& stream) const = 0;
};

}  // namespace npdr::sim
