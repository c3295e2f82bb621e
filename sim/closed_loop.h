/// Rollouts of an ODE model in closed loop with a policy, in batches of rows.
#pragma once

#include <functional>
#include <vector>

#include "core/types.h"
#include "sim/batch_integrator.h"
#include "sim/control_task.h"
#include "sim/ode_model.h"

namespace npdr::sim {

/// One batch of (domain parameters, initial state, policy), a row a lane, for an integrator to
/// advance: see sim/policy_task.h for what a step is. Lanes that fill up the last block repeat the
/// last row. Not thread-safe: one per thread.
///
/// The model makes of the actions what it makes of recorded ones: a delay reaches back to the first
/// action, which stands for all before it, so that a replay of a rollout's actions is that rollout.
class BatchClosedLoop final : public BatchProblem {
 public:
  /// Receives state t (S, L) for t = 1, ..., until all rollouts have ended.
  using Sink = std::function<void(Index t, ConstLanes y)>;

  /// theta (rows, P), initial_states (rows, S), policies (rows, Q); at least one row. T =
  /// num_steps. `model` and `task` must outlive the batch.
  BatchClosedLoop(const OdeModel& model, const ControlTask& task, Index num_steps,
                  const Eigen::Ref<const RowMatrix>& theta,
                  const Eigen::Ref<const RowMatrix>& initial_states,
                  const Eigen::Ref<const RowMatrix>& policies);

  /// Simulates all rows with an integrator of this batch, once. An empty sink is allowed.
  void run(BatchIntegrator& integrator, const Sink& sink = {});

  double total_reward(Index row) const { return return_(0, row); }
  /// Steps that were rewarded: T unless the rollout has ended early.
  Index rewarded_steps(Index row) const { return static_cast<Index>(steps_(0, row)); }
  bool is_success(Index row) const { return alive_(0, row) * held_(0, row) == 1.0; }
  Index num_actions() const { return commanded_.rows(); }
  /// a_t of a row, (A).
  Vector action(Index t, Index row) const;

  Index num_states() const override { return state_.rows(); }
  Index num_lanes() const override { return state_.cols(); }
  void begin_step(Index t) override;
  void rhs(const double* y, double* ydot) override;
  void end_step(Index t, const double* y) override;

 private:
  ActionSeries series() const;
  void keep_actions(Index t);
  void add_rewards();
  void end_rollouts_outside();

  const OdeModel& model_;
  const ControlTask& task_;
  Index num_steps_;
  RowMatrix policies_;   // (Q, L)
  RowMatrix constants_;  // (K, L)
  RowMatrix state_;      // (S, L)
  RowMatrix commanded_;  // (A, L)
  RowMatrix applied_;    // (A, L)
  RowMatrix actions_;    // (T A, L)
  RowMatrix alive_;      // (1, L) 1 or 0
  RowMatrix held_;       // (1, L) 1 or 0
  RowMatrix return_;     // (1, L)
  RowMatrix steps_;      // (1, L) whole numbers
  RowMatrix scratch_;    // (1, L)
  const Sink* sink_ = nullptr;
};

}  // namespace npdr::sim
