/// Replay of a target's rollouts by an ODE model, in batches of domain parameters.
#pragma once

#include <functional>
#include <vector>

#include "core/target.h"
#include "core/types.h"
#include "sim/batch_integrator.h"
#include "sim/ode_model.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::sim {

/// One batch of domain parameters, a row a lane, for an integrator to advance. Lanes that fill up
/// the last block repeat the last row. Not thread-safe: one per thread.
class BatchReplay final : public BatchProblem {
 public:
  /// Receives state t (S, L) for t = 1, ..., T.
  using Sink = std::function<void(Index t, ConstLanes y)>;

  /// theta: (rows, P), at least one row. `model` must outlive the batch.
  BatchReplay(const OdeModel& model, const Eigen::Ref<const RowMatrix>& theta);

  /// Simulates `rollout` with an integrator of this batch: from its first state, and again from the
  /// recorded state after every `segment_length` steps (0: never).
  void run(BatchIntegrator& integrator, const Rollout& rollout, Index segment_length,
           const Sink& sink);

  /// Whether theta and all states of a row so far are finite numbers that a float holds.
  bool is_finite(Index row) const { return finite_(0, row) == 1.0; }

  Index num_states() const override { return state_.rows(); }
  Index num_lanes() const override { return state_.cols(); }
  void begin_step(Index t) override;
  void rhs(const double* y, double* ydot) override;
  void end_step(Index t, const double* y) override;

 private:
  const OdeModel& model_;
  RowMatrix constants_;  // (K, L)
  RowMatrix applied_;    // (A, L)
  RowMatrix state_;      // (S, L) at the start of a segment
  RowMatrix finite_;     // (1, L) 1 or 0
  const Rollout* rollout_ = nullptr;
  const Sink* sink_ = nullptr;
};

/// Does what Simulator::replay promises, for `model` with the settings of `config`. Batches and
/// rollouts run in parallel.
Trajectories replay(const OdeModel& model, const SimulatorConfig& config, const Target& target,
                    const RowMatrix& theta);

/// One rollout of the model at the truth `theta` (P), moved by `excitation`, with all its states.
/// Throws Error when it diverges.
Rollout simulate(const OdeModel& model, const SimulatorConfig& config, const Vector& theta,
                 const Excitation& excitation);

}  // namespace npdr::sim
