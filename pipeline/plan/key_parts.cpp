#include "pipeline/plan/key_parts.h"

#include <filesystem>

#include "pipeline/config/study_json.h"

namespace npdr::pipeline {

using Json = nlohmann::ordered_json;

Json inference_json(const MethodConfig& method) {
  Json json = key_json(method);
  // Raised when their bits change, which leaves the keys of other posteriors as they are.
  constexpr int correction_version = 2, pool_version = 3;
  const bool is_corrected = inference::is_analytic(method.algorithm, method.density_estimator.kind);
  if (is_corrected) json["correction_version"] = correction_version;
  if (method.algorithm.kind == inference::Algorithm::npe_nle) json["pool_version"] = pool_version;
  return json;
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
  Json json = document_json(study);
  if (json.contains("simulator")) make_absolute(json["simulator"]);
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

}  // namespace npdr::pipeline
