#include "pipeline/report/policy_parts.h"

#include <fmt/format.h>

#include "pipeline/predictions/policy_rollouts.h"

namespace npdr::pipeline {

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

sim::PolicyTaskInfo task_info(const ReportData& data) { return make_task(data.plan.study)->info(); }

std::string policy_prose(const ReportData& data) {
  const PolicyConfig& policy = data.plan.study.policy;
  return fmt::format(
      "{}; searched for by {}: {} candidates an iteration, each on {} samples of what the method "
      "believes and {} initial states.",
      task_info(data).policy, name_of(policy.search.kind), policy.search.population,
      policy.num_domain_parameters, policy.num_initial_states);
}

}  // namespace npdr::pipeline
