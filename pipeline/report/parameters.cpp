#include "pipeline/report/parameters.h"

#include <fmt/format.h>

#include "core/normal.h"
#include "inference/prior.h"

namespace npdr::pipeline {
namespace {

using analysis::Cell;
using analysis::Row;
using analysis::Table;

std::string prior_text(const inference::Marginal& m) {
  switch (m.kind) {
    case inference::Marginal::Kind::uniform:
      return fmt::format("[{:.4g}, {:.4g}]", m.a, m.b);
    case inference::Marginal::Kind::log_uniform:
      return fmt::format("[{:.4g}, {:.4g}], log-uniform", m.a, m.b);
    case inference::Marginal::Kind::normal:
      return fmt::format("N({:.4g}, {:.4g}²)", m.a, m.b);
    case inference::Marginal::Kind::log_normal:
      return fmt::format("exp N({:.4g}, {:.4g}²)", m.a, m.b);
  }
  return "";
}

double period_of(const ReportData& data, const std::string& parameter) {
  return data.info.parameters[static_cast<std::size_t>(sim::parameter_index(data.info, parameter))]
      .period;
}

std::string period_note(double period) {
  return fmt::format("modulo {:.4g}: values that far apart are the same system", period);
}

// Parameter d of all samples of all seeds.
Vector pooled_theta(const std::vector<const EvaluatedRun*>& runs, Index d) {
  std::vector<double> values;
  for (const EvaluatedRun* run : runs) {
    const auto column = run->evaluation.theta.col(d);
    values.insert(values.end(), column.begin(), column.end());
  }
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

// Evenly spaced in probability: they stand for the prior whatever its kind.
Vector quantiles_of(const inference::Marginal& marginal) {
  constexpr Index count = 10'000;
  RowMatrix u(count, 1);
  for (Index i = 0; i < count; ++i) {
    u(i, 0) = normal_quantile((static_cast<double>(i) + 0.5) / static_cast<double>(count));
  }
  return inference::Prior({marginal}).to_theta(u).col(0);
}

std::size_t note_known(Table& table) {
  return table.footnote("not inferred by this method, which takes it as known");
}

}  // namespace

Table parameters_table(const ReportData& data) {
  Table table;
  table.name = "parameters";
  table.caption = "Domain parameters: mean and standard deviation of the posterior, all seeds.";
  table.row_header = "Parameter";
  table.command = data.plan.command;
  table.columns = {{"unit", false}, {"prior", false}};
  for (const BaselinePoint& point : data.baseline) table.columns.push_back({point.name, false});
  for (const std::string& method : data.methods) table.columns.push_back({method, false});
  for (Index d = 0; d < static_cast<Index>(data.plan.study.prior.size()); ++d) {
    const inference::Marginal& marginal = data.plan.study.prior[static_cast<std::size_t>(d)];
    Row row{marginal.name, {}};
    row.cells.emplace_back(marginal.unit);
    row.cells.emplace_back(prior_text(marginal));
    for (const BaselinePoint& point : data.baseline) row.cells.emplace_back(point.theta(d));
    const double period = period_of(data, marginal.name);
    for (const std::string& method : data.methods) {
      Cell cell(analysis::summarize_periodic(pooled_theta(data.runs_of(method), d), period));
      if (!data.is_inferred(method, d)) {
        cell = Cell(data.runs_of(method).front()->evaluation.theta(0, d));
        cell.notes.push_back(note_known(table));
      }
      if (period > 0.0) cell.notes.push_back(table.footnote(period_note(period)));
      row.cells.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table contraction_table(const ReportData& data) {
  Table table;
  table.name = "contraction";
  table.caption =
      "What the data tell about each parameter: 1 - posterior variance / prior variance, mean and "
      "standard deviation over seeds. 0: nothing, 1: all; below 0: the posterior is wider.";
  table.row_header = "Parameter";
  table.command = data.plan.command;
  for (const std::string& method : data.methods) table.columns.push_back({method, false});
  for (Index d = 0; d < static_cast<Index>(data.plan.study.prior.size()); ++d) {
    const inference::Marginal& marginal = data.plan.study.prior[static_cast<std::size_t>(d)];
    const double period = period_of(data, marginal.name);
    const double prior_std = analysis::summarize_periodic(quantiles_of(marginal), period).std;
    Row row{marginal.name, {}};
    for (const std::string& method : data.methods) {
      if (!data.is_inferred(method, d)) {
        row.cells.emplace_back();
        row.cells.back().notes.push_back(note_known(table));
        continue;
      }
      const auto runs = data.runs_of(method);
      Vector contraction(static_cast<Index>(runs.size()));
      for (Index i = 0; i < contraction.size(); ++i) {
        const auto& theta = runs[static_cast<std::size_t>(i)]->evaluation.theta;
        const double std = analysis::summarize_periodic(theta.col(d), period).std;
        contraction(i) = 1.0 - std * std / (prior_std * prior_std);
      }
      row.cells.emplace_back(analysis::summarize(contraction));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace npdr::pipeline
