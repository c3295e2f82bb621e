#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inference/prior.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

bool evaluates_rounds(const ReportData& data) {
  const EvaluateConfig& evaluate = data.plan.study.evaluate;
  return has_posteriors(data) && evaluate.rounds == EvaluatedRounds::all &&
         !evaluate.metrics.empty();
}

// Adds a column for each round of the method that has the most, "round 1", with `cell`(round,
// item).
template <class Item, class CellOf>
void add_rounds(const ReportData& data, TableOf<Item>& table, const CellOf& cell) {
  Index most = 0;
  for (const EvaluatedRun& run : data.runs) most = std::max(most, run.use.round);
  for (Index round = 1; round <= most; ++round) {
    table.add("round " + std::to_string(round),
              [round, cell](const Item& item) { return cell(round, item); });
  }
}

struct DensityRow {
  std::string method;
  KnownPoint point;
};

// Of the truth and references; of nominal parameters where there is neither.
std::vector<DensityRow> density_rows(const ReportData& data) {
  std::vector<KnownPoint> points = known_points(data);
  if (points.size() > 1 && data.plan.source->has_nominal()) points.erase(points.begin());
  std::vector<DensityRow> rows;
  for (const KnownPoint& point : points) {
    for (const std::string& method : data.methods) rows.push_back({method, point});
  }
  return rows;
}

Cell density_cell(const std::vector<const EvaluatedRun*>& runs, const DensityRow& row) {
  if (runs.empty()) return {};
  const analysis::Summary summary = analysis::summarize(
      each(runs, [&](const EvaluatedRun* run) { return row.point.log_prob(run->evaluation); }));
  if (summary.n == 0) return "outside";
  Cell cell(summary);
  if (summary.n_failed > 0) {
    cell.notes.push_back(
        fmt::format("of {} seeds only: to the others the point is impossible", summary.n));
  }
  return cell;
}

Cell prior_cell(const ReportData& data, const DensityRow& row) {
  const ParameterMap& parameters = data.plan.source->parameters();
  const Vector theta = parameters.pick_one(parameters.nominal(row.point.parameters));
  const double log_prob = inference::Prior(data.plan.study.prior).log_prob(theta.transpose())(0);
  return std::isfinite(log_prob) ? Cell(log_prob) : Cell("outside");
}

}  // namespace

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

/// One row a method and point (truth, references; nominal parameters where there is neither), one
/// column a round: log p of the posterior [nats], mean and standard deviation over the seeds,
/// beside that of the prior.
std::optional<Table> densities_table(const ReportData& data) {
  TableOf<DensityRow> table{
      .caption =
          "log p of known or measured parameters after each round, in nats: mean and "
          "standard deviation over the seeds.",
      .row_header = "Method, parameters",
      .rows = density_rows(data),
      .label = [](const DensityRow& row) { return row.method + ", " + row.point.name; },
      .last_notes = density_notes(data)};
  if (!evaluates_rounds(data) || table.rows.empty()) return std::nullopt;
  table.add("prior", [&](const DensityRow& row) { return prior_cell(data, row); });
  add_rounds(data, table, [&](Index round, const DensityRow& row) {
    return density_cell(data.runs_of(row.method, round), row);
  });
  return table.make();
}

}  // namespace npdr::pipeline
