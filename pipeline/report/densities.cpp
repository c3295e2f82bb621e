#include "pipeline/report/densities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/report/cells.h"

namespace npdr::pipeline {
namespace {

using analysis::Cell;
using analysis::Row;
using analysis::Table;

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
  if (points.empty() && study.source().has_nominal) {
    points.push_back(
        {"nominal", theta_of({}), [](const Evaluation& e) { return *e.nominal_log_prob; }});
  }
  return points;
}

Cell density_cell(const std::vector<const EvaluatedRun*>& runs, const Point& point, Table& table) {
  if (runs.empty()) return {};
  Vector values(static_cast<Index>(runs.size()));
  Index i = 0;
  for (const EvaluatedRun* run : runs) values(i++) = point.log_prob(run->evaluation);
  const analysis::Summary summary = analysis::summarize(values);
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

}  // namespace

Table densities_table(const ReportData& data) {
  Table table;
  table.name = "densities";
  table.caption =
      "log p of known or measured parameters after each round, in nats: mean and standard "
      "deviation over the seeds.";
  table.row_header = "Method, parameters";
  table.command = data.plan.command;
  table.columns.push_back({"prior", false});
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

// Densities of fewer parameters can't be compared with those of all.
void note_known_parameters(Table& table, const ReportData& data) {
  for (const std::string& method : data.methods) {
    std::vector<std::string> known;
    for (std::size_t d = 0; d < data.plan.study.prior.size(); ++d) {
      if (data.is_inferred(method, static_cast<Index>(d))) continue;
      known.push_back(data.plan.study.prior[d].name);
    }
    if (known.empty()) continue;
    table.footnote(fmt::format("{} takes as known: {}; its log p is the density of the others",
                               method, join(known)));
  }
}

// A reference may also set what the posterior takes for known.
void note_fixed_parameters(Table& table, const ReportData& data) {
  const auto& prior = data.plan.study.prior;
  for (const ReferenceConfig& reference : data.plan.study.references) {
    std::vector<std::string> fixed;
    for (const auto& [name, value] : reference.parameters) {
      const bool is_inferred =
          std::ranges::any_of(prior, [&](const auto& marginal) { return marginal.name == name; });
      if (!is_inferred) fixed.push_back(name);
    }
    if (fixed.empty()) continue;
    table.footnote(fmt::format(
        "log p({}) is the density of its parameters in the prior alone; the posterior has others "
        "of {}",
        reference.name, join(fixed)));
  }
}

}  // namespace npdr::pipeline
