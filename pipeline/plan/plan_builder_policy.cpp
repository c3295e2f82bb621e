// The part of a plan that is about policies.
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/plan_builder.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json grid_json(const PolicyGrid& grid) {
  Json json;
  for (const PolicyGridAxis* axis : {&grid.x, &grid.y}) {
    json.push_back({{"parameter", axis->parameter}, {"values", axis->points()}});
  }
  return json;
}

}  // namespace

std::size_t PlanBuilder::add_collection(const MethodConfig& method, const Use& use,
                                        std::size_t earlier, std::size_t policy) {
  const Study& study = plan_.study;
  Json json = key_document(kTargetSchema);
  json["simulator"] = keys_.truth;
  json["truth"] = *study.target.truth;
  json["num_rollouts"] = method.num_rollouts > 0 ? method.num_rollouts : study.target.num_rollouts;
  if (study.target.held_out > 0) json["held_out"] = study.target.held_out;
  json["task"] = key_json(study.policy, Affects::task);
  json["seed"] = use.seed;
  json["iteration"] = use.iteration;
  return add(Stage::target, json, use, {{"target", earlier}, {"policy", policy}});
}

std::size_t PlanBuilder::add_policy(const MethodConfig& method, const Use& use,
                                    std::optional<std::size_t> posterior,
                                    std::optional<std::size_t> start) {
  const Study& study = plan_.study;
  Json json = key_document(kPolicySchema);
  json["simulator"] = keys_.truth;
  json["task"] = key_json(study.policy, Affects::task);
  json["search"] = key_json(study.policy);
  json["num_iterations"] = method.policy_iterations;
  json["seed"] = use.seed;
  json["iteration"] = use.iteration;
  Inputs inputs;
  if (posterior) {
    inputs.push_back({"posterior", *posterior});
  } else {
    json["domain_parameters"] = name_of(method.algorithm.kind);
    if (method.algorithm.kind == inference::Algorithm::prior) json["prior"] = to_json(study.prior);
  }
  if (start) inputs.push_back({"policy", *start});
  return add(Stage::policy, json, use, inputs);
}

// A recorded target domain can't be asked what another policy does in it.
std::optional<std::size_t> PlanBuilder::add_policy_test(const Use& use,
                                                        std::optional<std::size_t> policy) {
  const Study& study = plan_.study;
  if (!study.target.truth && !study.policy.grid.is_used()) return std::nullopt;
  Json json = key_document(kPolicyTestSchema);
  json["simulator"] = keys_.truth;
  json["task"] = key_json(study.policy, Affects::task);
  if (study.target.truth) json["truth"] = *study.target.truth;
  if (study.policy.grid.is_used()) json["grid"] = grid_json(study.policy.grid);
  json["num_test_states"] = study.policy.num_test_states;
  json["seed"] = use.seed;
  Inputs inputs;
  if (policy) inputs.push_back({"policy", *policy});
  return add(Stage::policy_test, json, use, inputs);
}

}  // namespace npdr::pipeline
