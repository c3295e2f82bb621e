/// Questions that tests ask of plans.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "pipeline/plan/plan.h"

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

}  // namespace npdr::pipeline
