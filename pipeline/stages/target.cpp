#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/random.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/stages/closed_loop.h"
#include "pipeline/stages/policy_file.h"
#include "pipeline/stages/row_simulator.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/feature_file.h"
#include "pipeline/store/recording.h"
#include "sim/simulator.h"

namespace npdr::pipeline {
namespace {

// x_o of the truth: what the command makes of it.
Target simulated_observation(const Plan& plan, const Node& node) {
  const Study& study = plan.study;
  const auto simulator = make_row_simulator(plan, study.simulator, {}, log_of(node.path));
  const sim::SimulatorInfo info = simulator_info(study);
  const sim::Trajectories x =
      simulator->simulate(nominal_theta(study, info, *study.target.truth).transpose(),
                          {study.target.seed, "external_truth", 0, 0, 0});
  if (x.status.front() == sim::RolloutStatus::ok) {
    return observation_target(info.state_channels,
                              x.rollout(0, 0).row(0).cast<double>().transpose(),
                              "simulated at the truth");
  }
  throw Error(fmt::format("target.truth: simulator.command = '{}' gives no x_o there ({}): {}",
                          *study.external.command, sim::to_string(x.status.front()),
                          simulator->last_failure()));
}

void write_observation(h5::File& file, const Target& target) {
  const RowMatrix x = target.rollouts.front().states.bottomRows(1);
  h5::Dataset dataset = file.write("x", x);
  describe_columns(dataset, target.state_channels);
  dataset.label_dimensions({"row", "feature"});
  file.set_attribute("source", target.source);
}

// What a posterior explains of what it has seen says nothing about what it hasn't.
void check_held_out(const Target& seen, const Target& held_out) {
  for (const Rollout& rollout : held_out.rollouts) {
    for (const Rollout& other : seen.rollouts) {
      if (rollout.states != other.states || rollout.actions != other.actions) continue;
      throw InputError(fmt::format(
          "target.held_out: rollout '{}' is the same as '{}', which inference sees; must be left "
          "out where the behaviour isn't random",
          rollout.name, other.name));
    }
  }
}

// The rollouts that inference has seen, and what the policy of the last iteration makes of the
// simulated target domain.
Target collect(const Plan& plan, const Node& node) {
  const Use& use = node.uses.front();
  const MethodConfig& method = plan.study.method(use.method);
  const Use last{use.method, use.seed, 0, use.iteration - 1};
  Target target = read_target(plan, node, num_rollouts_seen(method, last));
  const Index count = target.num_rollouts() / std::max<Index>(1, last.iteration);
  const Target more = collect_rollouts(
      plan, target, read_policy(*plan.inputs(node, Stage::policy).front()), count,
      {use.seed, "policy_rollouts", static_cast<std::uint64_t>(use.iteration), 0, 0});
  target.rollouts.insert(target.rollouts.end(), more.rollouts.begin(), more.rollouts.end());
  return target;
}

}  // namespace

void run_target(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kTargetSchema, node.identity);
  if (plan.study.external.is_used()) {
    write_observation(writer.file(), plan.study.target.observation
                                         ? plan.target
                                         : simulated_observation(plan, node));
    writer.finish();
    return;
  }
  if (!plan.inputs(node, Stage::policy).empty()) {
    write_target(writer.file(), collect(plan, node));
    writer.finish();
    return;
  }
  const Target all = all_rollouts(plan);
  const Index num_seen = all.num_rollouts() - plan.study.target.held_out;
  const bool is_held_out = node.stage == Stage::held_out;
  const Target target = is_held_out ? all.after(num_seen) : all.first(num_seen);
  if (is_held_out) check_held_out(all.first(num_seen), target);
  write_target(writer.file(), target);
  writer.finish();
}

}  // namespace npdr::pipeline
