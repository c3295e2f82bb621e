#include <algorithm>

#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

Table make_rounds_table(const ReportData& data) {
  const auto& metrics = data.plan.study.evaluate.metrics;
  const bool has_rmse = std::ranges::count(metrics, Metric::rmse) > 0;
  const std::string metric = name_of(has_rmse ? Metric::rmse : metrics.front());
  Table table = empty_table(
      title_of(data, metric) + " of posterior samples after each round, all seeds.", "Method", {});
  const Index most_rounds = add_round_columns(table, data);
  for (const std::string& method : data.methods) {
    Row row{method, {}};
    for (Index round = 1; round <= most_rounds; ++round) {
      const auto runs = data.runs_of(method, round);
      row.cells.push_back(
          runs.empty() ? Cell()
                       : cell_of(table, analysis::summarize(pooled(runs, metric_samples(metric)))));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

/// One row a method, one column a round: RMSE, or the first metric of the study.
TableEntry rounds_table() {
  return {"rounds", Section::details, evaluates_rounds, make_rounds_table};
}

}  // namespace npdr::pipeline
