#include "pipeline/predictions/policy_rollouts.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

[[noreturn]] void fail_without_end(const std::string& name, std::string_view why) {
  throw Error(
      fmt::format("target.truth: '{}' under the searched policy has no end ({}); search for more "
                  "iterations, or use more simulator.substeps",
                  name, why));
}

// Replaces the states of `rollout` after step `begin` by what the system does under its actions, on
// its own from the first state.
void continue_rollout(const sim::Simulator& simulator, const Vector& theta, const Target& like,
                      Index begin, Rollout& rollout) {
  Target alone = like;
  alone.rollouts = {rollout};
  const sim::Trajectories replayed = simulator.replay(alone, theta.transpose());
  if (replayed.status.front() != sim::RolloutStatus::ok) {
    fail_without_end(rollout.name, sim::to_string(replayed.status.front()));
  }
  const auto states = replayed.rollout(0, 0);
  const Index left = rollout.num_steps() - begin;
  rollout.states.bottomRows(left) = states.bottomRows(left).cast<double>();
}

// A rollout of all steps, of one that may have ended early.
Rollout complete_rollout(const sim::Simulator& simulator, const Vector& theta, const Target& like,
                         const Rollout& recorded, const std::string& name) {
  if (!recorded.states.allFinite()) fail_without_end(name, "a state isn't finite");
  const Index steps = like.num_steps(), done = recorded.num_steps();
  Rollout rollout{name, RowMatrix::Zero(steps + 1, like.num_states()),
                  RowMatrix::Zero(steps, like.num_actions())};
  rollout.states.topRows(done + 1) = recorded.states;
  rollout.actions.topRows(done) = recorded.actions;
  if (done < steps) continue_rollout(simulator, theta, like, done, rollout);
  return rollout;
}

}  // namespace

std::unique_ptr<sim::PolicyTask> make_task(const Study& study, Index num_steps) {
  const Index steps = num_steps > 0 ? num_steps : study.policy.num_steps;
  return sim::make_policy_task(study.simulator, {.model = study.policy.model, .num_steps = steps});
}

Vector first_policy(const Study& study, const sim::PolicyTaskInfo& info) {
  Vector policy = sim::initial_policy(info);
  for (std::size_t q = 0; q < info.parameters.size(); ++q) {
    const auto found = study.policy.initial.find(info.parameters[q].name);
    if (found != study.policy.initial.end()) policy(static_cast<Index>(q)) = found->second;
  }
  return policy;
}

RowMatrix tested_parameters(const Study& study, const Source& source) {
  const PolicyGrid& grid = study.policy.grid;
  const sim::SimulatorInfo& info = source.info();
  const Vector base =
      source.parameters().nominal(study.target.truth.value_or(std::map<std::string, double>{}));
  const auto all_x = grid.is_used() ? grid.x.points() : std::vector<double>();
  const auto all_y = grid.is_used() ? grid.y.points() : std::vector<double>();
  Index row = study.target.truth ? 1 : 0;
  RowMatrix theta = base.transpose().replicate(row + std::ssize(all_x) * std::ssize(all_y), 1);
  for (const double x : all_x) {
    for (const double y : all_y) {
      theta(row, sim::parameter_index(info, grid.x.parameter)) = x;
      theta(row++, sim::parameter_index(info, grid.y.parameter)) = y;
    }
  }
  return theta;
}

Target collect_rollouts(const Plan& plan, const Target& like, const Vector& policy, Index count,
                        const StreamId& id) {
  const Study& study = plan.study;
  sim::SimulatorConfig in_one_piece = study.simulator;
  in_one_piece.segment_length = 0;
  in_one_piece.store_every = 1;
  const auto simulator = sim::make_simulator(in_one_piece);
  const auto task = make_task(study, like.num_steps());
  const Vector theta = plan.source->parameters().nominal(*study.target.truth);
  const sim::RecordedPolicyRollouts recorded =
      task->record(theta.transpose().replicate(count, 1), task->initial_states(count, id),
                   policy.transpose().replicate(count, 1));
  Target target = like;
  target.rollouts.clear();
  for (Index h = 0; h < count; ++h) {
    const std::string name = fmt::format("iteration {}, rollout {}", id.round, h + 1);
    target.rollouts.push_back(complete_rollout(
        *simulator, theta, like, recorded.rollouts[static_cast<std::size_t>(h)], name));
  }
  return target;
}

}  // namespace npdr::pipeline
