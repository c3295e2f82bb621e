#include "pipeline/plan/key_parts.h"

#include <filesystem>

#include "pipeline/config/method_settings.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {

using Json = nlohmann::ordered_json;

namespace {

// Distances of trajectories look at no embedding.
bool is_part_of_posterior(const MethodConfig& method, const std::string& key) {
  if (key == "name" || key == "published") return false;
  if (key == "num_rounds" || key == "num_simulations") return false;
  if (key == "num_iterations" || key == "policy_iterations") return false;
  const bool is_abc =
      inference::traits_of(method.algorithm.kind).family == inference::AlgorithmFamily::abc;
  if (is_abc && key == "embedding") {
    return method.abc.distance == inference::AbcDistance::euclidean;
  }
  return reads_setting(method.algorithm.kind, key);
}

}  // namespace

Json inference_json(const MethodConfig& method) {
  const Json all = to_json(method);
  Json json = Json::object();
  for (const auto& [key, value] : all.items()) {
    if (is_part_of_posterior(method, key)) json[key] = value;
  }
  // Whose posterior it is, its key among the inputs says.
  if (json.contains("refine")) json["refine"].erase("start");
  // Raised when their bits change, which leaves the keys of other posteriors as they are.
  constexpr int correction_version = 2, pool_version = 3;
  const bool is_corrected = inference::is_analytic(method.algorithm, method.density_estimator.kind);
  if (is_corrected) json["correction_version"] = correction_version;
  if (method.algorithm.kind == inference::Algorithm::npe_nle) json["pool_version"] = pool_version;
  return json;
}

Json noise_json(const ObservationNoise& noise) {
  Json json = to_json(noise);
  json.erase("redraw");
  return json;
}

namespace {

Json pick(const Json& all, const std::vector<std::string>& keys) {
  Json json = Json::object();
  for (const std::string& key : keys) json[key] = all.at(key);
  return json;
}

}  // namespace

Json policy_task_json(const PolicyConfig& policy) {
  return pick(to_json(policy), {"num_steps", "initial", "model"});
}

Json policy_search_json(const PolicyConfig& policy) {
  std::vector<std::string> keys = {"optimizer",          "population",  "num_domain_parameters",
                                   "num_initial_states", "initial_std", "min_std"};
  if (policy.search.kind == inference::PolicyOptimizerKind::power) {
    keys.emplace_back("num_importance_samples");
  } else {
    keys.insert(keys.end(), {"elite_fraction", "smoothing"});
  }
  return pick(to_json(policy), keys);
}

namespace {

// What makes rows again, wherever somebody asks for that.
void make_absolute(Json& simulator) {
  for (const char* key : {"library", "mjcf"}) {
    if (!simulator.contains(key) || !simulator[key].is_string()) continue;
    std::error_code gone;  // the current folder
    const auto path = std::filesystem::absolute(simulator[key].get<std::string>(), gone);
    if (!gone) simulator[key] = path.lexically_normal().string();
  }
}

}  // namespace

Json study_document(const Study& study) {
  Json json = to_json(study);
  json.erase("cluster");  // where something is computed changes nothing
  if (json.contains("simulator")) make_absolute(json["simulator"]);
  for (std::size_t i = 0; i < study.methods.size(); ++i) {
    if (!reads_setting(study.methods[i].algorithm.kind, "refine"))
      json["method"][i].erase("refine");
  }
  if (study.policy.is_used()) return json;
  json.erase("policy");
  for (Json& method : json["method"]) {
    method.erase("num_iterations");
    method.erase("policy_iterations");
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
  return study;
}

}  // namespace npdr::pipeline
