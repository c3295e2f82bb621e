#include "pipeline/plan/plan.h"

#include <algorithm>

#include "core/error.h"
#include "core/shell_text.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/plan_builder.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Target pick_by_fold(const Study& study, const Target& seen, Index fold, bool is_of_fold) {
  std::vector<Index> positions;
  for (Index h = 0; h < seen.num_rollouts(); ++h) {
    const bool is_left_out = fold > 0 && h % study.evaluate.leave_out == fold - 1;
    if (is_left_out == is_of_fold) positions.push_back(h);
  }
  return seen.pick(positions);
}

}  // namespace

Json study_document(const Study& study) {
  Json json = document_json(study);
  // What makes rows again, wherever somebody asks for that.
  for (const char* key : {"library", "mjcf"}) {
    if (!json.contains("simulator") || !json["simulator"].contains(key)) continue;
    Json& file = json["simulator"][key];
    std::error_code gone;  // the current folder
    if (!file.is_string()) continue;
    const auto path = std::filesystem::absolute(file.get<std::string>(), gone);
    if (!gone) file = path.lexically_normal().string();
  }
  return json;
}

Json without_folders(Json study) {
  const auto keep_name = [&](const char* table, const char* key) {
    if (!study.contains(table) || !study[table].contains(key)) return;
    Json& path = study[table][key];
    if (path.is_string()) path = std::filesystem::path(path.get<std::string>()).filename().string();
  };
  for (const char* key : {"recording", "observation", "inputs"}) keep_name("target", key);
  for (const char* key : {"library", "mjcf", "dataset"}) keep_name("simulator", key);
  if (study.contains("simulator")) study["simulator"].erase("folder");
  return study;
}

std::uint64_t Use::stream_round() const {
  const Index earlier = std::max<Index>(0, iteration - 1);
  return static_cast<std::uint64_t>(round) + (static_cast<std::uint64_t>(earlier) << 32);
}

std::string Node::label() const {
  const Use& use = uses.front();
  std::string text = name_of(stage);
  if (!use.method.empty()) text += " " + use.method + ", seed " + std::to_string(use.seed);
  if (use.iteration > 0) text += ", iteration " + std::to_string(use.iteration);
  if (use.round > 0) text += ", round " + std::to_string(use.round);
  if (stage == Stage::policy_test && use.iteration == 0) text += ", before any search";
  if (is_calibration(*this)) text += ", calibration";
  if (use.fold > 0) text += ", without fold " + std::to_string(use.fold);
  return text;
}

std::string Plan::command() const { return words.empty() ? "" : "npdr run " + shell_text(words); }

const Node& Plan::node(Stage stage, const Use& use) const {
  for (const Node& candidate : nodes) {
    if (candidate.stage != stage) continue;
    if (std::ranges::find(candidate.uses, use) != candidate.uses.end()) return candidate;
  }
  Node wanted;
  wanted.stage = stage;
  wanted.uses = {use};
  throw InputError("this study has no artefact '" + wanted.label() + "'");
}

const Node& Plan::node_by_key(const std::string& key) const {
  const Node* found = nullptr;
  for (const Node& candidate : nodes) {
    if (!candidate.key.starts_with(key)) continue;
    if (found != nullptr) throw InputError("key '" + key + "' is ambiguous; give more digits");
    found = &candidate;
  }
  if (found == nullptr) {
    throw InputError(
        "key '" + key +
        "' is not in the plan of this study; was the study, a file that it names, or a --set "
        "changed, maybe while it ran, or is it of another build of npdr (--version)? Run it again");
  }
  return *found;
}

std::string numbered(std::string_view name, Index number) {
  return std::string(name) + "_" + std::to_string(number);
}

const Node* Plan::find_input(const Node& node, std::string_view name) const {
  const auto found = std::ranges::find(node.inputs, name, &Input::name);
  return found == node.inputs.end() ? nullptr : &nodes[found->position];
}

const Node& Plan::input(const Node& node, std::string_view name) const {
  if (const Node* found = find_input(node, name)) return *found;
  throw Error(node.label() + ": has no input '" + std::string(name) + "'");
}

std::vector<const Node*> Plan::inputs(const Node& node, std::string_view name) const {
  std::vector<const Node*> found;
  for (const Input& input : node.inputs) {
    const std::size_t end = input.name.rfind('_');
    if (end != std::string::npos && input.name.substr(0, end) == name) {
      found.push_back(&nodes[input.position]);
    }
  }
  return found;
}

Plan make_plan(Study study, const WorkFolder& work, const Selection& selection) {
  return PlanBuilder(std::move(study), work, selection).build();
}

std::filesystem::path link_of(const Plan& plan, const Node& node, const Use& use) {
  std::filesystem::path folder = plan.work.study(plan.study.name);
  if (!use.method.empty()) {
    folder = folder / folder_slug(use.method) / ("seed-" + std::to_string(use.seed));
  }
  if (use.fold > 0) folder /= "without-fold-" + std::to_string(use.fold);
  if (use.iteration > 0) folder /= "iteration-" + std::to_string(use.iteration);
  if (use.round > 0) folder /= "round-" + std::to_string(use.round);
  if (is_calibration(node)) folder /= "calibration";
  return folder / (name_of(node.stage) + ".h5");
}

std::filesystem::path log_of(const Plan& plan, const Node& node) {
  return plan.work.study(plan.study.name) / "logs" / (folder_slug(node.label()) + ".log");
}

void link_uses(const Plan& plan, const Node& node) {
  if (node.stage == Stage::report) return;
  for (const Use& use : node.uses) make_link(node.path, link_of(plan, node, use));
}

Target without_fold(const Study& study, const Target& seen, Index fold) {
  return pick_by_fold(study, seen, fold, false);
}

Target of_fold(const Study& study, const Target& seen, Index fold) {
  return pick_by_fold(study, seen, fold, true);
}

bool is_calibration(const Node& node) {
  const bool has_rows = node.stage == Stage::propose || node.stage == Stage::simulate;
  return has_rows && node.uses.front().round == 0;
}

bool is_refinement(const Plan& plan, const Node& node) {
  if (node.stage != Stage::infer) return false;
  return family_of(plan.study.method(node.uses.front().method)) ==
         inference::AlgorithmFamily::likelihood;
}

bool simulates(const Plan& plan, const Node& node) {
  if (node.stage != Stage::infer) return false;
  const MethodConfig& method = plan.study.method(node.uses.front().method);
  return is_refinement(plan, node) || family_of(method) == inference::AlgorithmFamily::fit;
}

Index num_rollouts_seen(const MethodConfig& method, const Use& use) {
  return method.num_rollouts * std::max<Index>(1, use.iteration);
}

Index num_rows(const Plan& plan, const Node& node) {
  if (is_calibration(node)) return plan.study.diagnose.num_simulations;
  return plan.study.method(node.uses.front().method).algorithm.num_simulations;
}

}  // namespace npdr::pipeline
