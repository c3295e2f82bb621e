#include "pipeline/features/targets.h"

#include "pipeline/artefacts/target_file.h"

namespace npdr::pipeline {

Target read_target(const Plan& plan, const Node& node, Index num_rollouts) {
  Target target = read_target_artefact(*plan.inputs(node, Stage::target).front());
  return num_rollouts > 0 ? target.first(num_rollouts) : target;
}

Target read_seen_target(const Plan& plan, const Node& node) {
  const Use& use = node.uses.front();
  return read_target(plan, node, num_rollouts_seen(plan.study.method(use.method), use));
}

Target make_seen_target(const Plan& plan) {
  const Target all = plan.study.target.truth ? plan.source->behave({}) : plan.target;
  return all.first(all.num_rollouts() - plan.study.target.held_out);
}

std::optional<Target> read_held_out(const Plan& plan, const Node& node) {
  const auto sources = plan.inputs(node, Stage::held_out);
  if (sources.empty()) return std::nullopt;
  return read_target_artefact(*sources.front());
}

}  // namespace npdr::pipeline
