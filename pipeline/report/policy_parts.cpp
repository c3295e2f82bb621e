#include "pipeline/report/policy_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/predictions/policy_rollouts.h"

namespace npdr::pipeline {

bool is_tested_in_target(const ReportData& data) {
  return data.plan.study.target.truth.has_value();
}

bool is_tested_on_grid(const ReportData& data) { return data.plan.study.policy.grid.is_used(); }

bool is_tested(const ReportData& data) {
  return is_tested_in_target(data) || is_tested_on_grid(data);
}

std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        Searches searches) {
  std::vector<const PolicyTest*> tests;
  for (const auto& run : data.policy_tests) {
    const Searches of_run = run.use.iteration == 0 ? Searches::before : Searches::after;
    if (run.use.method == method && of_run == searches) tests.push_back(&run.result);
  }
  return tests;
}

std::vector<const PolicyHistory*> histories_of(const ReportData& data, const std::string& method,
                                               std::uint64_t seed) {
  std::vector<const PolicyHistory*> histories;
  for (const auto& run : data.policies) {  // iterations of one seed are in their order
    if (run.use.method == method && run.use.seed == seed) histories.push_back(&run.result);
  }
  return histories;
}

TableOf<std::string> table_of_policy_methods(const ReportData& data, std::string caption) {
  return {.caption = std::move(caption),
          .row_header = "Method",
          .rows = data.policy_methods(),
          .label = std::identity()};
}

sim::PolicyTaskInfo task_info(const ReportData& data) { return make_task(data.plan.study)->info(); }

std::vector<const Node*> nodes_of(const ReportData& data, const std::string& method,
                                  std::uint64_t seed, const std::vector<Stage>& stages) {
  const auto is_its = [&](const Use& use) { return use.method == method && use.seed == seed; };
  std::vector<const Node*> nodes;
  for (const Node& node : data.plan.nodes) {
    const bool is_wanted = std::ranges::count(stages, node.stage) > 0 && !is_calibration(node);
    if (is_wanted && std::ranges::any_of(node.uses, is_its)) nodes.push_back(&node);
  }
  return nodes;
}

std::string policy_prose(const ReportData& data) {
  const PolicyConfig& policy = data.plan.study.policy;
  return fmt::format(
      "{}; searched for by {}: {} candidates an iteration, each on {} samples of what the method "
      "believes and {} initial states.",
      task_info(data).policy, name_of(policy.search.kind), policy.search.population,
      policy.num_domain_parameters, policy.num_initial_states);
}

}  // namespace npdr::pipeline
