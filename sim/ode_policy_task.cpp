#include "sim/ode_policy_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "core/error.h"
#include "core/parallel.h"
#include "sim/batch_integrator.h"
#include "sim/closed_loop.h"
#include "sim/row_batches.h"
#include "sim/simulator_check.h"

namespace npdr::sim {
namespace {

void check_columns(const char* what, Index found, std::size_t expected) {
  if (found == static_cast<Index>(expected)) return;
  throw ShapeError(
      fmt::format("closed loop: {} of {} columns, must have {}", what, found, expected));
}

// Records a batch, a rollout a lane; nothing when there are no rollouts.
void begin_rollouts(const Eigen::Ref<const RowMatrix>& initial_states, Index num_steps,
                    std::span<Rollout> rollouts) {
  Index lane = 0;
  for (Rollout& rollout : rollouts) {
    rollout.states.setZero(num_steps + 1, initial_states.cols());
    rollout.states.row(0) = initial_states.row(lane++);
  }
}

BatchClosedLoop::Sink keep_states(std::span<Rollout> rollouts) {
  if (rollouts.empty()) return {};
  return [rollouts](Index t, ConstLanes y) {
    const double* lane = y.data;
    for (Rollout& rollout : rollouts) {
      for (Index s = 0; s < rollout.states.cols(); ++s) rollout.states(t, s) = lane[s * y.lanes];
      ++lane;
    }
  };
}

// Adds the actions, and cuts off what came after the end.
void finish_rollouts(const BatchClosedLoop& batch, std::span<Rollout> rollouts) {
  Index lane = 0;
  for (Rollout& rollout : rollouts) {
    const Index steps = batch.rewarded_steps(lane);
    rollout.states.conservativeResize(steps + 1, Eigen::NoChange);
    rollout.actions.resize(steps, batch.num_actions());
    for (Index t = 0; t < steps; ++t) rollout.actions.row(t) = batch.action(t, lane).transpose();
    ++lane;
  }
}

}  // namespace

OdePolicyTask::OdePolicyTask(std::shared_ptr<const OdeModel> model,
                             std::unique_ptr<ControlTask> task, SimulatorInfo info,
                             const SimulatorConfig& simulator, const PolicyTaskConfig& config)
    : model_(std::move(model)),
      task_(std::move(task)),
      simulator_info_(std::move(info)),
      task_info_(task_->info()),
      integrator_(simulator.integrator),
      substeps_(simulator.substeps) {
  if (config.num_steps < 0) {
    throw InputError(fmt::format("policy.num_steps = {}, must be >= 0", config.num_steps));
  }
  if (config.num_steps > 0) task_info_.num_steps = config.num_steps;
}

void OdePolicyTask::check_shapes(const RowMatrix& theta, const RowMatrix& initial_states,
                                 const RowMatrix& policies) const {
  check_num_parameters(theta.cols(), simulator_info_);
  check_columns("initial states", initial_states.cols(), simulator_info_.state_channels.size());
  check_columns("policies", policies.cols(), task_info_.parameters.size());
  if (initial_states.rows() == theta.rows() && policies.rows() == theta.rows()) return;
  throw ShapeError(fmt::format(
      "closed loop: {} rows of theta, {} initial states and {} policies, must be as many of each",
      theta.rows(), initial_states.rows(), policies.rows()));
}

PolicyRollouts OdePolicyTask::run(const RowMatrix& theta, const RowMatrix& initial_states,
                                  const RowMatrix& policies) const {
  return run_batches(theta, initial_states, policies, nullptr);
}

RecordedPolicyRollouts OdePolicyTask::record(const RowMatrix& theta,
                                             const RowMatrix& initial_states,
                                             const RowMatrix& policies) const {
  RecordedPolicyRollouts result;
  result.rollouts.resize(static_cast<std::size_t>(theta.rows()));
  result.outcomes = run_batches(theta, initial_states, policies, &result.rollouts);
  return result;
}

PolicyRollouts OdePolicyTask::run_batches(const RowMatrix& theta, const RowMatrix& initial_states,
                                          const RowMatrix& policies,
                                          std::vector<Rollout>* recorded) const {
  check_shapes(theta, initial_states, policies);
  const Index n = theta.rows();
  const Index batch_size = rows_per_batch(integrator_, n);
  PolicyRollouts result;
  result.resize(n);
  parallel_for((n + batch_size - 1) / batch_size, [&](Index task) {
    const Index first = task * batch_size, rows = std::min(batch_size, n - first);
    BatchClosedLoop batch(*model_, *task_, task_info_.num_steps, theta.middleRows(first, rows),
                          initial_states.middleRows(first, rows), policies.middleRows(first, rows));
    const auto integrator = make_integrator(integrator_, batch, task_info_.dt, substeps_);
    const std::span<Rollout> rollouts =
        recorded ? std::span(*recorded).subspan(static_cast<std::size_t>(first),
                                                static_cast<std::size_t>(rows))
                 : std::span<Rollout>();
    begin_rollouts(initial_states.middleRows(first, rows), task_info_.num_steps, rollouts);
    batch.run(*integrator, keep_states(rollouts));
    finish_rollouts(batch, rollouts);
    for (Index i = 0; i < rows; ++i)
      take_outcome(batch, i, theta.row(first + i), first + i, result);
  });
  return result;
}

void OdePolicyTask::take_outcome(const BatchClosedLoop& batch, Index lane,
                                 const Eigen::Ref<const Eigen::RowVectorXd>& theta, Index row,
                                 PolicyRollouts& result) const {
  const auto r = static_cast<std::size_t>(row);
  if (!is_possible(theta, simulator_info_)) {
    result.status[r] = RolloutStatus::out_of_limits;
    return;
  }
  result.returns(row) = batch.total_reward(lane);
  result.num_steps[r] = batch.rewarded_steps(lane);
  result.success[r] = batch.is_success(lane) ? 1 : 0;
}

std::vector<Index> OdePolicyTask::possible_rows(const RowMatrix& theta) const {
  check_num_parameters(theta.cols(), simulator_info_);
  std::vector<Index> rows;
  for (Index i = 0; i < theta.rows(); ++i) {
    if (is_possible(theta.row(i), simulator_info_)) rows.push_back(i);
  }
  return rows;
}

RowMatrix OdePolicyTask::initial_states(Index n, const StreamId& id) const {
  RowMatrix states(n, static_cast<Index>(simulator_info_.state_channels.size()));
  for (Index i = 0; i < n; ++i) {
    StreamId row = id;
    row.row = static_cast<std::uint64_t>(i);
    Stream stream(row);
    states.row(i) = task_->initial_state(stream).transpose();
  }
  return states;
}

}  // namespace npdr::sim
