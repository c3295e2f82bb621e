#include <algorithm>

#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {

/// One row a method, one column a round: RMSE, or the first metric of the study.
std::optional<Table> rounds_table(const ReportData& data) {
  if (!evaluates_rounds(data)) return std::nullopt;
  const auto& metrics = data.plan.study.evaluate.metrics;
  const bool has_rmse = std::ranges::count(metrics, Metric::rmse) > 0;
  const std::string metric = name_of(has_rmse ? Metric::rmse : metrics.front());
  TableOf<std::string> table{
      .caption = title_of(data, metric) + " of posterior samples after each round, all seeds.",
      .row_header = "Method",
      .rows = data.methods,
      .label = std::identity()};
  add_rounds(data, table, [&](Index round, const std::string& method) {
    const auto runs = data.runs_of(method, round);
    return runs.empty() ? Cell()
                        : cell_of(analysis::summarize(pooled(runs, metric_samples(metric))));
  });
  return table.make();
}

}  // namespace npdr::pipeline
