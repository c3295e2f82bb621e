#include <fmt/format.h>

#include "inference/prior.h"
#include "pipeline/findings/findings.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// The cell of a parameter that the method takes as known, as its footnote says.
Cell known_cell(Cell cell = {}) {
  cell.notes.emplace_back("not inferred by this method, which takes it as known");
  return cell;
}

std::string prior_text(const inference::Marginal& m) {
  switch (m.kind) {
    case inference::Marginal::Kind::uniform:
      return interval_text(m.a, m.b);
    case inference::Marginal::Kind::log_uniform:
      return interval_text(m.a, m.b) + ", log-uniform";
    case inference::Marginal::Kind::normal:
      return fmt::format("N({:.4g}, {:.4g}²)", m.a, m.b);
    case inference::Marginal::Kind::log_normal:
      return fmt::format("exp N({:.4g}, {:.4g}²)", m.a, m.b);
  }
  return "";
}

Cell posterior_cell(const ReportData& data, const std::string& method, Index d) {
  const double period = data.period_of(d);
  const Vector samples = samples_of(data, method, d);
  Cell cell =
      data.is_inferred(method, d) ? Cell(data.summary_of(d, samples)) : known_cell(samples(0));
  if (period > 0.0) {
    cell.notes.push_back(
        fmt::format("modulo {:.4g}: values that far apart are the same system", period));
  }
  return cell;
}

// Rows with their units.
TableOf<Index> table_with_units(const ReportData& data, const char* of_posteriors) {
  auto table = table_of_parameters(
      data, fmt::format("Domain parameters: {} of the posterior, all seeds.", of_posteriors));
  table.add("unit", [&](Index d) { return data.marginal(d).unit; });
  return table;
}

}  // namespace

/// Prior, baselines and posteriors: mean and deviation, circular for a periodic parameter.
std::optional<Table> parameters_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  auto table = table_with_units(data, "mean and standard deviation");
  table.add("prior", [&](Index d) { return prior_text(data.marginal(d)); });
  for (const BaselinePoint& point : data.baseline.points) {
    table.add(point.name, [&](Index d) { return point.theta(d); });
  }
  table.add_each(data.methods, [&](const std::string& method, Index d) {
    return posterior_cell(data, method, d);
  });
  for (const Finding& finding : data.dataset) table.last_notes.push_back(finding.what);
  return table.make();
}

/// What 90 % of each posterior's samples lie in, parameter by parameter: 5 % and 95 % quantiles.
std::optional<Table> intervals_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  auto table = table_with_units(data, "5 % and 95 % quantiles");
  table.add_each(data.methods, [&](const std::string& method, Index d) -> Cell {
    if (!data.is_inferred(method, d)) return {};
    return interval_text(unwrapped_samples_of(data, method, d));
  });
  return table.make();
}

/// Contraction of each parameter (findings.h).
std::optional<Table> contraction_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  auto table = table_of_parameters(
      data,
      "What the data tell about each parameter: 1 - posterior variance / prior variance, mean and "
      "standard deviation over seeds. 0: nothing, 1: all; below 0: the posterior is wider. Of "
      "logarithms where the prior is log_uniform or log_normal.");
  table.add_each(data.methods, [&](const std::string& method, Index d) {
    return data.is_inferred(method, d) ? Cell(analysis::summarize(contraction(data, method, d)))
                                       : known_cell();
  });
  return table.make();
}

}  // namespace npdr::pipeline
