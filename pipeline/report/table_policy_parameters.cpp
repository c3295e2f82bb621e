#include <fmt/format.h>

#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

Table make_policy_parameters_table(const ReportData& data) {
  Table table =
      empty_table("Parameters of the policies that the searches found.", "Method, seed", {});
  for (const sim::PolicyParameter& parameter : task_info(data).parameters) {
    add_columns(table, {fmt::format("{} [{}]", parameter.name, parameter.unit)});
  }
  const auto number = [](double value) { return value; };
  const RowMatrix& first = data.policies.front().result.policies;
  add_row(table, "before any search", first.row(0), number);
  for (const std::string& method : data.policy_methods()) {
    for (const std::uint64_t seed : data.seeds) {
      const RowMatrix& policies = last_history(data, method, seed).policies;
      add_row(table, experiment_label(method, seed), policies.row(policies.rows() - 1), number);
    }
  }
  return table;
}

}  // namespace

/// One row a method and seed: the parameters of the policy that was found.
TableEntry policy_parameters_table() {
  return {"policy_parameters", Section::policies, has_policies, make_policy_parameters_table};
}

}  // namespace npdr::pipeline
