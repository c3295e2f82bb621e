#include "pipeline/features/targets.h"

#include "pipeline/artefacts/recording.h"

namespace npdr::pipeline {

Target read_target(const Plan& plan, const Node& node, Index num_rollouts) {
  Target target = read_target_artefact(plan.input(node, "target"));
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
  const Node* held_out = plan.find_input(node, "held_out");
  if (held_out == nullptr) return std::nullopt;
  return read_target_artefact(*held_out);
}

}  // namespace npdr::pipeline
