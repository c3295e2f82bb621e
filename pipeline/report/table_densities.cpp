#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "inference/prior.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// A point in the space of parameters, and where evaluations hold its density.
struct Point {
  std::string name;
  Vector theta;  // (D) in the order of the prior
  std::function<double(const Evaluation&)> log_prob;
};

std::vector<Point> points_of(const ReportData& data) {
  const Study& study = data.plan.study;
  const ParameterMap& parameters = data.plan.source->parameters();
  const auto theta_of = [&](const std::map<std::string, double>& values) {
    return parameters.pick_one(parameters.nominal(values));
  };
  std::vector<Point> points;
  if (study.target.truth) {
    points.push_back({"truth", theta_of(*study.target.truth),
                      [](const Evaluation& e) { return *e.truth_log_prob; }});
  }
  for (const ReferenceConfig& reference : study.references) {
    points.push_back(
        {reference.name, theta_of(reference.parameters),
         [&reference](const Evaluation& e) { return e.reference_log_prob.at(reference.name); }});
  }
  if (points.empty() && data.plan.source->has_nominal()) {
    points.push_back(
        {"nominal", theta_of({}), [](const Evaluation& e) { return *e.nominal_log_prob; }});
  }
  return points;
}

Cell density_cell(const std::vector<const EvaluatedRun*>& runs, const Point& point, Table& table) {
  if (runs.empty()) return {};
  const analysis::Summary summary = analysis::summarize(
      each(runs, [&](const EvaluatedRun* run) { return point.log_prob(run->evaluation); }));
  if (summary.n == 0) return "outside";
  Cell cell(summary);
  if (summary.n_failed > 0) {
    cell.notes.push_back(table.footnote(
        fmt::format("of {} seeds only: to the others the point is impossible", summary.n)));
  }
  return cell;
}

Cell prior_cell(const ReportData& data, const Point& point) {
  const inference::Prior prior(data.plan.study.prior);
  const double log_prob = prior.log_prob(point.theta.transpose())(0);
  return std::isfinite(log_prob) ? Cell(log_prob) : Cell("outside");
}

bool has_points(const ReportData& data) {
  return evaluates_rounds(data) && !points_of(data).empty();
}

Table make_densities_table(const ReportData& data) {
  Table table = empty_table(
      "log p of known or measured parameters after each round, in nats: mean and standard "
      "deviation over the seeds.",
      "Method, parameters", {"prior"});
  const Index most_rounds = add_round_columns(table, data);
  for (const Point& point : points_of(data)) {
    for (const std::string& method : data.methods) {
      Row row{fmt::format("{}, {}", method, point.name), {prior_cell(data, point)}};
      for (Index round = 1; round <= most_rounds; ++round) {
        row.cells.push_back(density_cell(data.runs_of(method, round), point, table));
      }
      table.rows.push_back(std::move(row));
    }
  }
  note_fixed_parameters(table, data);
  note_known_parameters(table, data);
  return table;
}

}  // namespace

/// One row a method and point (truth, references; nominal parameters where there is neither), one
/// column a round: log p of the posterior [nats], mean and standard deviation over the seeds,
/// beside that of the prior.
TableEntry densities_table() {
  return {"densities", Section::details, has_points, make_densities_table};
}

}  // namespace npdr::pipeline
