#include <fmt/format.h>

#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// A method and seed: the policy that its last search found.
struct PolicyOfSeed {
  std::string label;
  Vector parameters;
  const PolicyHistory* last_search = nullptr;
  std::size_t seed = 0;  // its place among the seeds
  std::string method = {};
};

TableOf<PolicyOfSeed> table_of_policies_of_seeds(const ReportData& data, std::string caption) {
  TableOf<PolicyOfSeed> table{.caption = std::move(caption),
                              .row_header = "Method, seed",
                              .rows = {},
                              .label = &PolicyOfSeed::label};
  for (const std::string& method : data.policy_methods()) {
    for (std::size_t s = 0; s < data.seeds.size(); ++s) {
      const PolicyHistory* last = histories_of(data, method, data.seeds[s]).back();
      table.rows.push_back({experiment_label(method, data.seeds[s]),
                            last->policies.bottomRows(1).transpose(), last, s, method});
    }
  }
  return table;
}

}  // namespace

/// One row a method and seed: its policy in the target domain and under what the method believes.
std::optional<Table> policy_seeds_table(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  using Policy = const PolicyOfSeed&;
  auto table = table_of_policies_of_seeds(
      data,
      "Policies of each experiment: in the target domain, and under what the method believes.");
  if (is_tested_in_target(data)) {
    const auto in_target = [&data](Policy policy, Searches searches, Outcome outcome) {
      const PolicyTest* test = tests_of(data, policy.method, searches).at(policy.seed);
      return analysis::summarize(outcome_samples(&PolicyTest::target, outcome)(test));
    };
    constexpr auto returns = &PolicyOutcomes::returns, success = &PolicyOutcomes::success;
    using enum Searches;
    table.add("return before", [=](Policy p) { return in_target(p, before, returns); });
    table.add("success before", [=](Policy p) { return in_target(p, before, success).mean; });
    table.add("return", [=](Policy p) { return in_target(p, after, returns); });
    table.add("success", [=](Policy p) { return in_target(p, after, success).mean; });
  }
  const auto last = [](const Vector& values) { return values(values.size() - 1); };
  table.add("believed return", [=](Policy p) { return last(p.last_search->mean_return); });
  table.add("believed success", [=](Policy p) { return last(p.last_search->success_rate); });
  table.add("impossible parameters", [](Policy p) { return p.last_search->num_impossible; });
  table.last_notes = {
      "believed: over fresh samples of what the method takes the domain parameters for (posterior, "
      "prior or nominal); impossible parameters: samples that were left out of the last search"};
  return table.make();
}

/// One row a method and seed: the parameters of the policy that was found.
std::optional<Table> policy_parameters_table(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  auto table =
      table_of_policies_of_seeds(data, "Parameters of the policies that the searches found.");
  const Vector first = data.policies.front().result.policies.row(0).transpose();
  table.rows.insert(table.rows.begin(), {"before any search", first});
  Index p = 0;
  for (const sim::PolicyParameter& parameter : task_info(data).parameters) {
    table.add(fmt::format("{} [{}]", parameter.name, parameter.unit),
              [p](const PolicyOfSeed& policy) { return policy.parameters(p); });
    ++p;
  }
  return table.make();
}

}  // namespace npdr::pipeline
