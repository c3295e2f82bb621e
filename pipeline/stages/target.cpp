#include <fmt/format.h>

#include "core/error.h"
#include "core/random.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/stages/stages.h"
#include "pipeline/store/recording.h"
#include "sim/simulator.h"

namespace npdr::pipeline {
namespace {

// All rollouts of the truth: those that inference sees, and the held-out ones.
Target simulated_target(const Study& study) {
  const auto simulator = sim::make_simulator(study.simulator);
  std::map<std::string, double> values = study.simulator.parameters;
  for (const auto& [name, value] : *study.target.truth) values[name] = value;
  return simulator->behave(sim::complete_theta(*simulator, values),
                           study.target.num_rollouts + study.target.held_out, study.target.seed);
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

}  // namespace

void run_target(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kTargetSchema, node.identity);
  const Target all = plan.study.target.recording ? plan.target : simulated_target(plan.study);
  const Index num_seen = all.num_rollouts() - plan.study.target.held_out;
  const bool is_held_out = node.stage == Stage::held_out;
  const Target target = is_held_out ? all.after(num_seen) : all.first(num_seen);
  if (is_held_out) check_held_out(all.first(num_seen), target);
  write_target(writer.file(), target);
  writer.finish();
}

}  // namespace npdr::pipeline
