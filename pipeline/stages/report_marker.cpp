#include "pipeline/stages/report_marker.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"

namespace npdr::pipeline {

bool report_is_current(const Plan& plan, const Node& node) {
  if (!std::filesystem::exists(report_path(plan))) return false;
  std::ifstream file(node.path);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  return json.is_object() && json.contains("key") && json["key"] == node.key;
}

void unmark_report(const Node& node) { std::filesystem::remove(node.path); }

void mark_report(const Plan&, const Node& node) {
  const nlohmann::ordered_json json = {{"key", node.key},
                                       {"key_document", node.identity.key_document}};
  write_text_file(node.path, json.dump(2) + "\n");
}

std::filesystem::path report_path(const Plan& plan) {
  return plan.work.study(plan.study.name) / "report.html";
}

}  // namespace npdr::pipeline
