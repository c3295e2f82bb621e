/// A physical system given by an ordinary differential equation, vectorized over lanes.
///
/// With state y (S), action a (A) held over a time step, and domain parameters theta (P):
///   dy/dt = f(y, a; theta).
/// A batch simulates one rollout a lane, each with its own theta, and all of them with the same
/// recorded actions or each with those of its controller; arrays are (quantity, lanes), see
/// sim/lanes.h. What f needs of theta is worked out once per batch (prepare), what it needs of the
/// actions once per time step (apply_action), so that f itself (rhs), evaluated several times a
/// step, is as short as can be.
///
/// All members are const and thread-safe; all arrays belong to the caller.
#pragma once

#include <cstdint>

#include "core/types.h"
#include "sim/control_task.h"
#include "sim/lanes.h"
#include "sim/simulator.h"

namespace npdr::sim {

/// The actions of every step of every lane; a view that doesn't own them. They are the same in all
/// lanes (recorded ones: lane stride 0) or each lane's own (those of a controller).
struct ActionSeries {
  const double* data = nullptr;
  Index step_stride = 0;
  Index channel_stride = 0;
  Index lane_stride = 0;

  double at(Index t, Index channel, Index lane) const {
    return data[t * step_stride + channel * channel_stride + lane * lane_stride];
  }
};

/// The rows of `actions` (T, A) in every lane.
inline ActionSeries in_every_lane(const RowMatrix& actions) {
  return {actions.data(), actions.cols(), 1, 0};
}

/// Initial state and actions of one rollout of a simulated target domain.
struct Excitation {
  Vector initial_state;  ///< (S)
  RowMatrix actions;     ///< (T, A)
};

class OdeModel {
 public:
  virtual ~OdeModel() = default;

  /// Parameters with their nominal values, channels, and the time steps of excite().
  virtual const SimulatorInfo& info() const = 0;

  /// Number K of per-lane constants.
  virtual Index num_constants() const = 0;

  /// theta (P, lanes) -> constants (K, lanes).
  virtual void prepare(ConstLanes theta, Lanes constants) const = 0;

  /// The action (A, lanes) that each lane's system feels during step t, given the `actions` of
  /// steps 0, ..., t; later ones are not looked at. By default that is the action of step t.
  virtual void apply_action(const ActionSeries& actions, Index t, ConstLanes constants,
                            Lanes applied) const;

  /// ydot (S, lanes) = f(y, applied; constants).
  virtual void rhs(ConstLanes constants, ConstLanes applied, ConstLanes y, Lanes ydot) const = 0;

  /// The behavior policy and initial state of rollout `rollout` of a simulated target domain.
  virtual Excitation excite(Index rollout, std::uint64_t seed) const = 0;

  /// Serves Simulator::regression_form().
  virtual std::unique_ptr<RegressionForm> regression_form() const;

  /// The policy and rewards of the system's closed-loop task; nullptr: it has none. `model` (P):
  /// the domain parameters as the policy believes them to be.
  virtual std::unique_ptr<ControlTask> control_task(const Vector& model) const;
};

}  // namespace npdr::sim
