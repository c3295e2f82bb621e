#include "pipeline/report/inference_chains.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/process/build_info.h"
#include "pipeline/process/utc_time.h"

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

NetcdfGroup make_group(h5::File& file, const std::string& name) {
  NetcdfGroup group(file.create_group(name));
  group.attributes().set_attribute("created_at", now_utc());
  group.attributes().set_attribute("inference_library", std::string("npdr"));
  group.attributes().set_attribute("inference_library_version", creator_version());
  return group;
}

NetcdfGroup make_group(h5::File& file, const std::string& name, const std::vector<Index>& seeds,
                       Index num_draws) {
  NetcdfGroup group = make_group(file, name);
  group.dimension("chain", seeds);
  std::vector<Index> draws(static_cast<std::size_t>(num_draws));
  std::iota(draws.begin(), draws.end(), Index{0});
  group.dimension("draw", draws);
  return group;
}

}  // namespace npdr::pipeline
