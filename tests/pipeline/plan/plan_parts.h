/// Questions that tests ask of plans.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "pipeline/config/study_reader.h"
#include "pipeline/plan/plan.h"
#include "tests/study_text.h"

namespace npdr::pipeline {

/// Keys of all nodes of a stage.
inline std::set<std::string> keys(const Plan& plan, Stage stage) {
  std::set<std::string> found;
  for (const Node& node : plan.nodes) {
    if (node.stage == stage) found.insert(node.key);
  }
  return found;
}

/// Nodes of a stage.
inline Index count(const Plan& plan, Stage stage) {
  return std::ranges::count(plan.nodes, stage, &Node::stage);
}

/// Stages of what a node needs, in its order.
inline std::vector<Stage> inputs_of(const Plan& plan, const Node& node) {
  std::vector<Stage> stages;
  for (const std::size_t i : node.needs) stages.push_back(plan.nodes[i].stage);
  return stages;
}

/// A study of two methods, one of two rounds, and two seeds.
inline StudyText two_methods() {
  return StudyText("two")
      .with("study", {"seeds = [1, 2]"})
      .with("target", {"truth = {}"})
      .with("simulator", {"name = \"pendulum\""})
      .with("prior", {"pole_mass = { uniform = [0.3, 1.7] }"})
      .method("A", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 100",
                    "embedding = { kind = \"bayessim\" }"})
      .method("B", {"num_simulations = 100", "embedding = { kind = \"bayessim\" }",
                    "density_estimator = { kind = \"mdn\" }"});
}

/// Its plan.
inline Plan plan_of(const std::vector<std::string>& overrides = {},
                    const Selection& selection = {}) {
  return make_plan(parse_study(std::string(two_methods()), "two.toml", overrides),
                   WorkFolder("runs"), selection);
}

/// Names of rollouts, one after the other.
inline std::string names_of(const Target& target) {
  std::string names;
  for (const Rollout& rollout : target.rollouts) names += rollout.name;
  return names;
}

}  // namespace npdr::pipeline
