#include "pipeline/report/policy_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/predictions/policy_rollouts.h"

namespace npdr::pipeline {

bool is_tested_in_target(const ReportData& data) {
  return data.plan.study.target.truth.has_value();
}

bool is_tested_on_grid(const ReportData& data) { return data.plan.study.policy.grid.is_used(); }

std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        bool is_before) {
  std::vector<const PolicyTest*> tests;
  for (const auto& run : data.policy_tests) {
    if (run.use.method == method && (run.use.iteration == 0) == is_before) {
      tests.push_back(&run.result);
    }
  }
  return tests;
}

const PolicyHistory& last_history(const ReportData& data, const std::string& method,
                                  std::uint64_t seed) {
  const ResultOf<PolicyHistory>* last = nullptr;
  for (const auto& run : data.policies) {
    if (run.use.method != method || run.use.seed != seed) continue;
    if (last == nullptr || run.use.iteration > last->use.iteration) last = &run;
  }
  return last->result;
}

sim::PolicyTaskInfo task_info(const ReportData& data) { return make_task(data.plan.study)->info(); }

bool is_used_by(const Node& node, const std::string& method, std::uint64_t seed) {
  const auto is_its = [&](const Use& use) { return use.method == method && use.seed == seed; };
  return !is_calibration(node) && std::ranges::any_of(node.uses, is_its);
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
