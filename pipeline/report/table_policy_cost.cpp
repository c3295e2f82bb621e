#include <algorithm>

#include "pipeline/plan/completeness.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// Core-hours of one experiment in a group of stages; what methods share counts for each.
double core_hours(const ReportData& data, const std::string& method, std::uint64_t seed,
                  const std::vector<Stage>& stages) {
  double seconds = 0.0;
  for (const Node& node : data.plan.nodes) {
    if (std::ranges::find(stages, node.stage) == stages.end()) continue;
    if (!is_used_by(node, method, seed) || !is_complete(data.plan, node)) continue;
    seconds += read_artefact_info(node.path).provenance.cost.core_seconds;
  }
  return seconds / 3600.0;
}

Table make_policy_cost_table(const ReportData& data) {
  const std::vector<std::pair<std::string, std::vector<Stage>>> groups = {
      {"simulation", {Stage::target, Stage::propose, Stage::simulate}},
      {"inference", {Stage::infer}},
      {"policy search", {Stage::policy}},
      {"all", {Stage::target, Stage::propose, Stage::simulate, Stage::infer, Stage::policy}}};
  Table table =
      empty_table("What policies took: core-hours of one experiment, mean and standard deviation.",
                  "Method", {});
  for (const auto& group : groups) add_columns(table, {group.first});
  for (const std::string& method : data.policy_methods()) {
    add_row(table, method, groups, [&](const auto& group) {
      return analysis::summarize(each(data.seeds, [&](std::uint64_t seed) {
        return core_hours(data, method, seed, group.second);
      }));
    });
  }
  table.footnote(
      "what several methods share counts for each of them; without tests and evaluations; times "
      "differ from run to run");
  return table;
}

}  // namespace

/// One row a method: core-hours. They are times, so that two runs that computed the same differ.
TableEntry policy_cost_table() {
  return {"policy_cost", Section::policies, has_policies, make_policy_cost_table};
}

}  // namespace npdr::pipeline
