/// The interface of what advances a batch of ODEs in time.
#pragma once

#include <memory>

#include "core/types.h"
#include "sim/integrator.h"

namespace npdr::sim {

/// A batch of initial value problems whose right-hand side changes from one time step to the next,
/// since actions are held over a step. Arrays are (S, L), see sim/lanes.h. The members are called
/// from C code and must not throw.
class BatchProblem {
 public:
  virtual ~BatchProblem() = default;

  virtual Index num_states() const = 0;  ///< S
  virtual Index num_lanes() const = 0;   ///< L, a multiple of kLaneBlock

  /// Called once before step t: from here on rhs() is that of step t.
  virtual void begin_step(Index t) = 0;

  /// ydot = f(y) during the current step.
  virtual void rhs(const double* y, double* ydot) = 0;

  /// Called once after step t with the state that it led to.
  virtual void end_step(Index t, const double* y) = 0;
};

/// Integrates one BatchProblem, which must outlive it. Not thread-safe: one per thread.
class BatchIntegrator {
 public:
  virtual ~BatchIntegrator() = default;

  /// Advances the state from y (S, L) over the steps first, first + 1, ..., last - 1. A lane that
  /// diverges goes on as NaN or infinity and leaves the others alone.
  virtual void integrate(Index first, Index last, const double* y) = 0;
};

/// An integrator for steps of dt [s], each made of `substeps` equal ones where the integrator has a
/// fixed step.
std::unique_ptr<BatchIntegrator> make_integrator(Integrator integrator, BatchProblem& problem,
                                                 double dt, Index substeps);

/// Whether the integrator picks its own steps. Such an integrator takes one row at a time, so that
/// the steps of a row don't depend on others, and computes only lane 0 of a batch.
bool is_adaptive(Integrator integrator);

}  // namespace npdr::sim
