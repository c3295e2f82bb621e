#include <fmt/format.h>

#include <string>

#include "inference/prior.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

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

std::string period_note(double period) {
  return fmt::format("modulo {:.4g}: values that far apart are the same system", period);
}

Cell posterior_cell(Table& table, const ReportData& data, const std::string& method, Index d) {
  const double period = data.period_of(d);
  const Vector samples = samples_of(data, method, d);
  Cell cell(data.summary_of(d, samples));
  if (!data.is_inferred(method, d)) {
    cell = Cell(samples(0));
    note_known(table, cell);
  }
  if (period > 0.0) cell.notes.push_back(table.footnote(period_note(period)));
  return cell;
}

// 5 % and 95 % quantiles.
Cell interval_cell(const ReportData& data, const std::string& method, Index d) {
  if (!data.is_inferred(method, d)) return {};
  return interval_text(unwrapped_samples_of(data, method, d));
}

Table make_intervals(const ReportData& data) {
  Table table =
      empty_table("Domain parameters: 5 % and 95 % quantiles of the posterior, all seeds.",
                  "Parameter", {"unit"});
  add_columns(table, data.methods);
  Index d = 0;
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    Row row{marginal.name, {marginal.unit}};
    for (const std::string& method : data.methods) {
      row.cells.push_back(interval_cell(data, method, d));
    }
    table.rows.push_back(std::move(row));
    ++d;
  }
  return table;
}

Table make_parameters_table(const ReportData& data) {
  Table table =
      empty_table("Domain parameters: mean and standard deviation of the posterior, all seeds.",
                  "Parameter", {"unit", "prior"});
  for (const BaselinePoint& point : data.baseline.points) add_columns(table, {point.name});
  add_columns(table, data.methods);
  Index d = 0;
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    Row row{marginal.name, {marginal.unit, prior_text(marginal)}};
    for (const BaselinePoint& point : data.baseline.points) row.cells.emplace_back(point.theta(d));
    for (const std::string& method : data.methods) {
      row.cells.push_back(posterior_cell(table, data, method, d));
    }
    table.rows.push_back(std::move(row));
    ++d;
  }
  for (const Finding& finding : data.dataset) table.footnote(finding.what);
  return table;
}

}  // namespace

/// Prior, baselines and posteriors: mean and deviation, circular for a periodic parameter.
TableEntry parameters_table() {
  return {"parameters", Section::posteriors, has_posteriors, make_parameters_table};
}

/// What 90 % of each posterior's samples lie in, parameter by parameter.
TableEntry intervals_table() {
  return {"intervals", Section::posteriors, has_posteriors, make_intervals};
}

}  // namespace npdr::pipeline
