/// A physical system given by an ordinary differential equation, vectorised over lanes.
///
/// With state y (S), action a (A) held over a time step, and domain parameters theta (P):
///   dy/dt = f(y, a; theta).
/// A batch simulates one rollout a lane, all of them with the same recorded actions but each with
/// its own theta; arrays are (quantity, lanes), see sim/lanes.h. What f needs of theta is worked
/// out once per batch (prepare), what it needs of the recorded actions once per time step
/// (apply_action), so that f itself (rhs), evaluated several times a step, is as short as can be.
///
/// All members are const and thread-safe; all arrays belong to the caller.
#pragma once

#include <cstdint>

#include "core/types.h"
#include "sim/lanes.h"
#include "sim/simulator.h"

namespace npdr::sim {

/// What moves a simulated target domain in one rollout.
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

  /// The action (A, lanes) that each lane's system feels during step t, given the recorded
  /// `actions` (T, A) of the whole rollout. By default that is row t of them, in every lane.
  virtual void apply_action(const RowMatrix& actions, Index t, ConstLanes constants,
                            Lanes applied) const;

  /// ydot (S, lanes) = f(y, applied; constants).
  virtual void rhs(ConstLanes constants, ConstLanes applied, ConstLanes y, Lanes ydot) const = 0;

  /// The behaviour policy and initial state of rollout `rollout` of a simulated target domain.
  virtual Excitation excite(Index rollout, std::uint64_t seed) const = 0;

  /// As Simulator::regression_form().
  virtual std::unique_ptr<RegressionForm> regression_form() const;
};

}  // namespace npdr::sim
