// The part of a plan that is about the target domain: what inference sees, what is held out or left
// out, and the policies that are searched for and tested.
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/plan_builder.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

// Rollouts of the target: what was recorded of them, or how the truth is simulated.
template <class Recorded>
void describe_rollouts(const Study& study, const SourceKeys& keys, const Recorded& recorded,
                       Json& json) {
  if (study.target.recording || study.target.observation) {
    json["content"] = content_hash(recorded());
    return;
  }
  json["simulator"] = keys.truth;
  json["truth"] = *study.target.truth;
  json["num_rollouts"] = study.target.num_rollouts;
  json["seed"] = study.target.seed;
}

Json grid_json(const PolicyGrid& grid) {
  Json json;
  for (const PolicyGridAxis* axis : {&grid.x, &grid.y}) {
    json.push_back({{"parameter", axis->parameter}, {"values", axis->points()}});
  }
  return json;
}

}  // namespace

std::size_t PlanBuilder::add_target() {
  const Study& study = plan_.study;
  Json json = key_document(kTargetSchema);
  if (study.target.recording) {
    Recording recording =
        read_recording(*study.target.recording, channels_of(plan_.source->info()));
    plan_.recorded_actions = std::move(recording.recorded.actions);
    plan_.target = std::move(recording);
    check_recording(study, plan_.target);
    std::vector<Index> picked;
    for (const std::uint64_t number : study.target.rollouts) {
      picked.push_back(static_cast<Index>(number) - 1);
    }
    if (!picked.empty()) plan_.target = plan_.target.pick(picked);
    if (study.target.num_rollouts > 0) {
      plan_.target = plan_.target.first(study.target.num_rollouts + study.target.held_out);
    }
  }
  const auto seen = [&] {
    return plan_.target.first(plan_.target.num_rollouts() - study.target.held_out);
  };
  describe_rollouts(study, keys_, seen, json);
  return add(Stage::target, json, {}, {});
}

// The rollouts after those of the target; none: nothing is held out.
std::optional<std::size_t> PlanBuilder::add_held_out() {
  const Study& study = plan_.study;
  if (study.target.held_out == 0) return std::nullopt;
  Json json = key_document(kTargetSchema);
  json["held_out"] = study.target.held_out;
  const auto rest = [&] {
    return plan_.target.after(plan_.target.num_rollouts() - study.target.held_out);
  };
  describe_rollouts(study, keys_, rest, json);
  return add(Stage::held_out, json, {}, {});
}

PlanBuilder::Fold PlanBuilder::add_fold(Index fold) {
  const Study& study = plan_.study;
  const auto add_part = [&](Stage stage, Target (*part)(const Study&, const Target&, Index)) {
    Json json = key_document(kTargetSchema);
    if (stage == Stage::held_out) json["held_out"] = "fold";
    const auto recorded = [&] {
      const Index num_seen = plan_.target.num_rollouts() - study.target.held_out;
      return part(study, plan_.target.first(num_seen), fold);
    };
    describe_rollouts(study, keys_, recorded, json);
    if (!study.target.recording) json["fold"] = {fold, study.evaluate.leave_out};
    return add(stage, json, {.fold = fold}, {});
  };
  return {add_part(Stage::target, &without_fold), add_part(Stage::held_out, &of_fold)};
}

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

std::size_t PlanBuilder::add_policy(const MethodConfig& method, const Use& use, Position posterior,
                                    Position start) {
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
std::optional<std::size_t> PlanBuilder::add_policy_test(const Use& use, Position policy) {
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
