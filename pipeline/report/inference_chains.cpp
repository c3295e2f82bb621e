#include "pipeline/report/inference_chains.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

bool is_last(const Plan& plan, const Use& use) {
  const MethodConfig& method = plan.study.method(use.method);
  const Index iteration = use.iteration > 0 ? plan.study.num_iterations_of(method) : 0;
  return use.fold == 0 && use.round == method.algorithm.num_rounds && use.iteration == iteration;
}

}  // namespace

Chains find_chains(const Plan& plan) {
  Chains chains;
  std::vector<std::string> methods;
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::evaluate) continue;
    for (const Use& use : node.uses) {
      if (!is_last(plan, use)) continue;
      if (std::ranges::find(methods, use.method) == methods.end()) methods.push_back(use.method);
      chains.nodes.push_back(&node);
      chains.seeds.push_back(static_cast<Index>(use.seed));
    }
  }
  if (methods.size() != 1) {
    throw InputError(
        fmt::format("study '{}' evaluates posteriors of {}, must be one; name it with "
                    "--only{}",
                    plan.study.name, counted(std::ssize(methods), "method"),
                    methods.empty() ? "" : ": " + join(methods)));
  }
  chains.method = methods.front();
  for (const Node* node : chains.nodes) {
    if (!std::filesystem::exists(node->path)) {
      throw InputError(node->label() + ": isn't made yet; first: " + plan.command);
    }
    chains.evaluations.push_back(kEvaluationSchema.read(*node));
  }
  return chains;
}

}  // namespace npdr::pipeline
