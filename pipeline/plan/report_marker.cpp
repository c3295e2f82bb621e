#include "pipeline/plan/report_marker.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"

namespace npdr::pipeline {

bool report_is_current(const Plan& plan, const Node& node) {
  if (!std::filesystem::exists(report_path(plan))) return false;
  std::ifstream file(node.path);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object() || !json.contains("key") || json["key"] != node.key) return false;
  const auto files = json.find("files");
  return files != json.end() && std::ranges::all_of(*files, [&](const auto& name) {
           return name.is_string() && std::filesystem::exists(node.path.parent_path() /
                                                              name.template get<std::string>());
         });
}

void unmark_report(const Node& node) { std::filesystem::remove(node.path); }

void mark_report(const Node& node, const std::vector<std::filesystem::path>& files) {
  std::vector<std::string> names;
  for (const auto& file : files) {
    names.push_back(file.lexically_relative(node.path.parent_path()).generic_string());
  }
  const nlohmann::ordered_json json = {
      {"key", node.key}, {"files", names}, {"key_document", node.identity.key_document}};
  // In ASCII: titles may hold characters that turn what a terminal shows.
  write_text_file(node.path, json.dump(2, ' ', true) + "\n");
}

std::filesystem::path report_path(const Plan& plan) {
  return plan.work.study(plan.study.name) / "report.html";
}

}  // namespace npdr::pipeline
