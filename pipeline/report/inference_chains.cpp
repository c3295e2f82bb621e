#include "pipeline/report/inference_chains.h"

#include "pipeline/plan/completeness.h"

namespace npdr::pipeline {

Chains find_chains(const Plan& plan) {
  Chains chains;
  for (const auto& [node, use] : last_nodes_of_method(plan, Stage::evaluate)) {
    chains.method = use.method;
    chains.seeds.push_back(static_cast<Index>(use.seed));
    chains.nodes.push_back(node);
    chains.evaluations.push_back(kEvaluationSchema.read(*node));
  }
  return chains;
}

}  // namespace npdr::pipeline
