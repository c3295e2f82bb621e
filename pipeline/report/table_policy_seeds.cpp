#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

Row seed_row(const ReportData& data, const std::string& method, std::size_t seed) {
  Row row{experiment_label(method, data.seeds[seed]), {}};
  if (is_tested_in_target(data)) {
    for (const bool is_before : {true, false}) {
      const PolicyTest* test = tests_of(data, method, is_before).at(seed);
      for (const Outcome outcome : {&PolicyOutcomes::returns, &PolicyOutcomes::success}) {
        const Vector samples = outcome_samples(&PolicyTest::target, outcome)(test);
        const analysis::Summary summary = analysis::summarize(samples);
        const bool is_share = outcome == &PolicyOutcomes::success;
        row.cells.push_back(is_share ? Cell(summary.mean) : Cell(summary));
      }
    }
  }
  const PolicyHistory& history = last_history(data, method, data.seeds[seed]);
  const Index last = history.num_rows() - 1;
  row.cells.emplace_back(history.mean_return(last));
  row.cells.emplace_back(history.success_rate(last));
  row.cells.emplace_back(history.num_impossible);
  return row;
}

Table make_policy_seeds_table(const ReportData& data) {
  Table table = empty_table(
      "Policies of each experiment: in the target domain, and under what the method believes.",
      "Method, seed", {});
  if (is_tested_in_target(data)) {
    add_columns(table, {"return before", "success before", "return", "success"});
  }
  add_columns(table, {"believed return", "believed success", "impossible parameters"});
  for (const std::string& method : data.policy_methods()) {
    for (std::size_t seed = 0; seed < data.seeds.size(); ++seed) {
      table.rows.push_back(seed_row(data, method, seed));
    }
  }
  table.footnote(
      "believed: over fresh samples of what the method takes the domain parameters for (posterior, "
      "prior or nominal); impossible parameters: samples that were left out of the last search");
  return table;
}

}  // namespace

/// One row a method and seed: its policy in the target domain and under what the method believes.
TableEntry policy_seeds_table() {
  return {"policy_seeds", Section::policies, has_policies, make_policy_seeds_table};
}

}  // namespace npdr::pipeline
