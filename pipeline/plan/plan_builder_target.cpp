// The part of a plan that is about the target: what inference sees, what is held out or left out.
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/rollout_check.h"
#include "pipeline/plan/plan_builder.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

// Those that a study counts from 1.
std::vector<Index> positions(const TargetConfig& target) {
  std::vector<Index> positions;
  for (const std::uint64_t rollout : target.rollouts) {
    positions.push_back(static_cast<Index>(rollout) - 1);
  }
  return positions;
}

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

}  // namespace

std::size_t PlanBuilder::add_target() {
  const Study& study = plan_.study;
  Json json = key_document(kTargetSchema);
  if (study.target.recording) {
    Recording recording =
        read_whole_recording(*study.target.recording, channels_of(plan_.source->info()));
    plan_.target = std::move(recording.target);
    plan_.recorded_actions = std::move(recording.channels.actions);
    check_recording(study, plan_.target);
    if (!study.target.rollouts.empty()) plan_.target = plan_.target.pick(positions(study.target));
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

}  // namespace npdr::pipeline
