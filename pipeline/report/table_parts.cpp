#include "pipeline/report/table_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/quantile.h"
#include "core/text.h"

namespace npdr::pipeline {

Table empty_table(std::string caption, std::string row_header,
                  const std::vector<std::string>& columns) {
  Table table;
  table.caption = std::move(caption);
  table.row_header = std::move(row_header);
  add_columns(table, columns);
  return table;
}

void add_columns(Table& table, const std::vector<std::string>& titles) {
  for (const std::string& title : titles) table.columns.push_back({title, false});
}

std::vector<std::string> baseline_names(const ReportData& data) {
  std::vector<std::string> names;
  if (data.baseline.prior) names.emplace_back("prior");
  for (const BaselinePoint& point : data.baseline.points) names.push_back(point.name);
  return names;
}

Index add_round_columns(Table& table, const ReportData& data) {
  Index most_rounds = 0;
  for (const EvaluatedRun& run : data.runs) most_rounds = std::max(most_rounds, run.use.round);
  for (Index round = 1; round <= most_rounds; ++round) {
    add_columns(table, {fmt::format("round {}", round)});
  }
  return most_rounds;
}

std::string title_of(const ReportData& data, const std::string& metric) {
  if (metric.starts_with(kHeldOutPrefix)) {
    return title_of(data, metric.substr(kHeldOutPrefix.size())) + ", held out";
  }
  return traits_of(parse_enum<Metric>("metric", metric)).title(data.info);
}

std::string experiment_label(const std::string& method, std::uint64_t seed) {
  return fmt::format("{}, {}", method, seed);
}

Cell cell_of(Table& table, const analysis::Summary& summary) {
  Cell cell(summary);
  note_failed(table, cell, summary);
  return cell;
}

void note_failed(Table& table, Cell& cell, const analysis::Summary& summary) {
  if (summary.n_failed == 0) return;
  cell.notes.push_back(
      table.footnote(fmt::format("{} of {} samples left out: their simulations failed",
                                 summary.n_failed, summary.n + summary.n_failed)));
}

Cell cell_of_seeds(Table& table, const analysis::Summary& summary) {
  Cell cell(summary);
  if (summary.n_failed > 0) {
    cell.notes.push_back(table.footnote(
        fmt::format("of {} of {} seeds: of the others every rollout failed, in one part at least",
                    summary.n, summary.n + summary.n_failed)));
  }
  return cell;
}

std::string noiseless_bands_text(const Study& study) {
  if (!study.target.recording || study.observation_noise.is_silent()) return "";
  return " The recording has noise: without it bands are of what lies below, and hold less.";
}

std::string interval_text(double low, double high) {
  return fmt::format("[{:.4g}, {:.4g}]", low, high);
}

std::string interval_text(const Vector& samples) {
  std::vector<double> sorted(samples.begin(), samples.end());
  std::ranges::sort(sorted);
  return interval_text(quantile_of_sorted(sorted, 0.05), quantile_of_sorted(sorted, 0.95));
}

Vector samples_of(const ReportData& data, const std::string& method, Index d) {
  return pooled(data.runs_of(method),
                [d](const EvaluatedRun* run) -> Vector { return run->evaluation.theta.col(d); });
}

Vector unwrapped_samples_of(const ReportData& data, const std::string& method, Index d) {
  Vector samples = samples_of(data, method, d);
  const double period = data.period_of(d);
  if (!(period > 0.0)) return samples;
  const double mean = data.summary_of(d, samples).mean;
  return samples.unaryExpr([&](double v) { return mean + std::remainder(v - mean, period); });
}

void note_known(Table& table, Cell& cell) {
  cell.notes.push_back(table.footnote("not inferred by this method, which takes it as known"));
}

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

void note_fixed_parameters(Table& table, const ReportData& data) {
  const auto& prior = data.plan.study.prior;
  for (const ReferenceConfig& reference : data.plan.study.references) {
    std::vector<std::string> fixed;
    for (const auto& [name, value] : reference.parameters) {
      const auto is_it = [&, &name = name](const auto& marginal) { return marginal.name == name; };
      if (std::ranges::none_of(prior, is_it)) fixed.push_back(name);
    }
    if (fixed.empty()) continue;
    table.footnote(fmt::format(
        "log p({}) is the density of its parameters in the prior alone; the posterior has others "
        "of {}",
        reference.name, join(fixed)));
  }
}

}  // namespace npdr::pipeline
