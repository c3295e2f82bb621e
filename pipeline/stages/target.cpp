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

}  // namespace

void run_target(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kTargetSchema, node.identity);
  const Target all = plan.study.target.recording ? plan.target : simulated_target(plan.study);
  const Index num_seen = all.num_rollouts() - plan.study.target.held_out;
  write_target(writer.file(),
               node.stage == Stage::held_out ? all.after(num_seen) : all.first(num_seen));
  writer.finish();
}

}  // namespace npdr::pipeline
