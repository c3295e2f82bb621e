#include "pipeline/report/cells.h"

#include <fmt/format.h>

#include <algorithm>

namespace npdr::pipeline {

using analysis::Cell;
using analysis::Table;

std::string title_of(const ReportData& data, const std::string& metric) {
  if (metric.starts_with(kHeldOutPrefix)) {
    return title_of(data, metric.substr(kHeldOutPrefix.size())) + ", held out";
  }
  if (metric == "dtw") return "DTW dist.";
  if (metric == "rmse") return "RMSE";
  if (metric == "final_error") {
    return fmt::format("Final error [{}]", data.info.state_channels.front().unit);
  }
  if (metric == kFeatureMetric) return "Distance to x_o [prior std]";
  return fmt::format("P({})", data.info.goal->description);
}

Cell cell_of(Table& table, const analysis::Summary& summary) {
  Cell cell(summary);
  if (summary.n_failed > 0) {
    cell.notes.push_back(
        table.footnote(fmt::format("{} of {} samples left out: their simulations failed",
                                   summary.n_failed, summary.n + summary.n_failed)));
  }
  return cell;
}

Index add_round_columns(analysis::Table& table, const ReportData& data) {
  Index most_rounds = 0;
  for (const EvaluatedRun& run : data.runs) most_rounds = std::max(most_rounds, run.use.round);
  for (Index round = 1; round <= most_rounds; ++round) {
    table.columns.push_back({fmt::format("round {}", round), false});
  }
  return most_rounds;
}

}  // namespace npdr::pipeline
