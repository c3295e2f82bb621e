#include "pipeline/plan/completeness.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// Core-hours of one experiment in some stages; what methods share counts for each.
double core_hours(const ReportData& data, const std::string& method, std::uint64_t seed,
                  const std::vector<Stage>& stages) {
  double seconds = 0.0;
  for (const Node* node : nodes_of(data, method, seed, stages)) {
    if (!is_complete(data.plan, *node)) continue;
    seconds += read_artefact_info(node->path).provenance.cost.core_seconds;
  }
  return seconds / 3600.0;
}

}  // namespace

/// One row a method: core-hours. They are times, so that two runs that computed the same differ.
std::optional<Table> policy_cost_table(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  auto table = table_of_policy_methods(
      data, "What policies took: core-hours of one experiment, mean and standard deviation.");
  const auto add = [&](const char* title, const std::vector<Stage>& stages) {
    table.add(title, [&data, stages](const std::string& method) {
      return analysis::summarize(each(
          data.seeds, [&](std::uint64_t seed) { return core_hours(data, method, seed, stages); }));
    });
  };
  add("simulation", {Stage::target, Stage::propose, Stage::simulate});
  add("inference", {Stage::infer});
  add("policy search", {Stage::policy});
  add("all", {Stage::target, Stage::propose, Stage::simulate, Stage::infer, Stage::policy});
  table.last_notes = {
      "what several methods share counts for each of them; without tests and evaluations; times "
      "differ from run to run"};
  return table.make();
}

}  // namespace npdr::pipeline
