#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/normal.h"
#include "inference/prior.h"
#include "pipeline/artefacts/proposal_file.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/report/parts.h"

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

constexpr Index kMostProposed = 10'000;  // of a proposal, all of them draws of the same

// Parameters (n, D) that a round of a method has simulated, of all seeds; of an outer loop in its
// last iteration.
RowMatrix proposals_of(const ReportData& data, const MethodConfig& method, Index round) {
  const Index last_iteration = data.plan.study.num_iterations_of(method);
  RowMatrix all(0, std::ssize(data.plan.study.prior));
  for (const Node& node : data.plan.nodes) {
    const bool is_its = std::ranges::any_of(node.uses, [&](const Use& use) {
      const bool is_last = use.iteration == 0 || use.iteration == last_iteration;
      return use.method == method.name && use.round == round && use.fold == 0 && is_last;
    });
    if (node.stage != Stage::propose || !is_its || !is_complete(data.plan, node)) continue;
    const h5::Dataset theta = open_proposal(node);
    const RowMatrix rows = read_proposal(theta, {0, std::min(kMostProposed, theta.num_rows())});
    all.conservativeResize(all.rows() + rows.rows(), Eigen::NoChange);
    all.bottomRows(rows.rows()) = rows;
  }
  return all;
}

// Intervals of the prior, or of what a round has simulated, of each parameter.
struct ProposalRow {
  std::string label;
  std::vector<std::string> intervals;
};

ProposalRow prior_row(const ReportData& data) {
  ProposalRow row{"prior", {}};
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    const Eigen::Vector2d u(normal_quantile(0.05), normal_quantile(0.95));
    const RowMatrix theta = inference::Prior({marginal}).to_theta(u);
    row.intervals.push_back(interval_text(theta(0, 0), theta(1, 0)));
  }
  return row;
}

std::vector<ProposalRow> proposal_rows(const ReportData& data) {
  std::vector<ProposalRow> rows = {prior_row(data)};
  for (const std::string& name : data.methods) {
    const MethodConfig& method = data.plan.study.method(name);
    for (Index round = 2; round <= method.algorithm.num_rounds; ++round) {
      const RowMatrix theta = proposals_of(data, method, round);
      if (theta.rows() == 0) continue;  // no longer there
      ProposalRow& row = rows.emplace_back(ProposalRow{fmt::format("{}, {}", name, round), {}});
      for (const auto& column : theta.colwise()) row.intervals.push_back(interval_text(column));
    }
  }
  return rows;
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

/// One row a method and round beyond the first, one column a parameter.
std::optional<Table> proposals_table(const ReportData& data) {
  const auto has_rounds = [&](const std::string& method) {
    return data.plan.study.method(method).algorithm.num_rounds > 1;
  };
  if (std::ranges::none_of(data.methods, has_rounds)) return std::nullopt;
  TableOf<ProposalRow> table{
      .caption =
          "Where rounds have simulated: 5 % and 95 % quantiles of their proposals, all "
          "seeds. Round 1 draws from the prior, each further one where the posterior of "
          "the round before it is.",
      .row_header = "Method, round",
      .rows = proposal_rows(data),
      .label = &ProposalRow::label};
  for (std::size_t d = 0; d < data.plan.study.prior.size(); ++d) {
    table.add(data.plan.study.prior[d].name,
              [d](const ProposalRow& row) { return row.intervals[d]; });
  }
  return table.make();
}

}  // namespace npdr::pipeline
