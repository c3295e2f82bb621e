#include "pipeline/report/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/metrics.h"
#include "pipeline/report/cells.h"

namespace npdr::pipeline {
namespace {

using analysis::Cell;
using analysis::MeanStd;
using analysis::Row;
using analysis::Table;

// All samples of all seeds, one after the other.
Vector pooled(const std::vector<const EvaluatedRun*>& runs, const std::string& metric) {
  std::vector<double> values;
  for (const EvaluatedRun* run : runs) {
    const Vector& part = run->evaluation.metrics.at(metric);
    values.insert(values.end(), part.begin(), part.end());
  }
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

Vector seed_means(const std::vector<const EvaluatedRun*>& runs, const std::string& metric) {
  Vector means(static_cast<Index>(runs.size()));
  for (Index i = 0; i < means.size(); ++i) {
    means(i) =
        analysis::summarize(runs[static_cast<std::size_t>(i)]->evaluation.metrics.at(metric)).mean;
  }
  return means;
}

void note_failed_rows(Table& table, const ReportData& data) {
  for (const std::string& method : data.methods) {
    Index used = 0, failed = 0;
    for (const EvaluatedRun* run : data.runs_of(method)) {
      used += run->notes.rows.used;
      failed += run->notes.rows.failed;
    }
    if (failed > 0) {
      table.footnote(fmt::format("{}: {} of {} simulations failed and were left out of training",
                                 method, failed, used + failed));
    }
  }
}

// What a regression's samples are like, which nothing keeps inside of the prior.
void note_regressions(Table& table, const ReportData& data) {
  for (const std::string& method : data.methods) {
    RegressionCounts sum;
    for (const EvaluatedRun* run : data.runs_of(method)) {
      const RegressionCounts counts = run->notes.regression.value_or(RegressionCounts{});
      sum.samples += counts.samples;
      sum.non_physical += counts.non_physical;
      sum.outside_prior += counts.outside_prior;
    }
    if (sum.samples == 0) continue;
    table.footnote(
        fmt::format("{}: {} of {} samples lie outside of the prior, {} are physically impossible",
                    method, sum.outside_prior, sum.samples, sum.non_physical));
  }
}

// Columns of the fit table: ours, published, then single parameter vectors.
void add_fit_columns(Table& table, const ReportData& data) {
  for (const std::string& method : data.methods) {
    table.columns.push_back({method, false});
    if (!data.plan.study.method(method).published.empty()) table.columns.push_back({method, true});
  }
  for (const BaselinePoint& point : data.baseline) table.columns.push_back({point.name, false});
}

// Simulations that went well, but have no distance: there is nothing to measure it in.
bool has_no_scale(const EvaluatedRun& run, const std::string& metric) {
  const auto& x = run.evaluation.x;
  return metric == kFeatureMetric && x && x->array().isFinite().any() &&
         run.evaluation.metrics.at(metric).array().isNaN().all();
}

Cell fit_cell(Table& table, const std::vector<const EvaluatedRun*>& runs,
              const std::string& metric) {
  if (!has_no_scale(*runs.front(), metric)) {
    return cell_of(table, analysis::summarize(pooled(runs, metric)));
  }
  Cell cell("none");
  cell.notes.push_back(table.footnote("no feature varies over the simulations of the prior"));
  return cell;
}

Row fit_row(Table& table, const ReportData& data, const std::string& metric) {
  Row row{title_of(data, metric), {}};
  for (const std::string& method : data.methods) {
    row.cells.push_back(fit_cell(table, data.runs_of(method), metric));
    const auto& published = data.plan.study.method(method).published;
    if (published.empty()) continue;
    const auto figure = published.find(metric);
    row.cells.push_back(figure == published.end()
                            ? Cell()
                            : Cell(MeanStd{figure->second.mean, figure->second.std, 0}));
  }
  for (const BaselinePoint& point : data.baseline) row.cells.emplace_back(point.metrics.at(metric));
  return row;
}

Row seed_means_row(const ReportData& data, const std::string& metric) {
  Row row{title_of(data, metric) + ", seed means", {}};
  for (const std::string& method : data.methods) {
    row.cells.emplace_back(analysis::summarize(seed_means(data.runs_of(method), metric)));
    if (!data.plan.study.method(method).published.empty()) row.cells.emplace_back();
  }
  row.cells.resize(row.cells.size() + data.baseline.size());
  return row;
}

std::string noise_text(const ObservationNoise& noise) {
  if (noise.scale == 0.0) return "Without observation noise.";
  return fmt::format("Observation noise {} of each channel's maximum, {}.", noise.scale,
                     noise.redraw ? "redrawn in every epoch" : "drawn once per simulation");
}

}  // namespace

Table fit_table(const ReportData& data) {
  const EvaluateConfig& evaluate = data.plan.study.evaluate;
  Table table;
  table.name = "fit";
  table.caption = fmt::format(
      "Fit of posterior samples to the target domain: mean and standard deviation over {} samples "
      "of {}. {}",
      evaluate.num_samples, data.each_experiment(), noise_text(data.plan.study.observation_noise));
  table.row_header = "Metric";
  table.command = data.plan.command;
  add_fit_columns(table, data);
  for (const std::string& metric : measured_names(data.plan.study)) {
    table.rows.push_back(fit_row(table, data, metric));
    if (data.seeds.size() > 1) table.rows.push_back(seed_means_row(data, metric));
  }
  note_failed_rows(table, data);
  note_regressions(table, data);
  if (data.plan.study.source().predicts_features()) {
    table.footnote(
        "Distance to x_o: root of the mean over features of ((x - x_o) / s)², s the standard "
        "deviation of the feature over simulations of the prior");
  }
  return table;
}

void note_recorded_goal(const ReportData& data, const Target& target,
                        const std::optional<Target>& held_out, Table& table) {
  if (std::ranges::count(data.plan.study.evaluate.metrics, "goal") == 0) return;
  const auto reached = [&](const Target& rollouts) {
    std::vector<float> states;  // as if they had been simulated
    for (const Rollout& rollout : rollouts.rollouts) {
      const RowMatrixF after = rollout.states.bottomRows(rollout.num_steps()).cast<float>();
      states.insert(states.end(), after.data(), after.data() + after.size());
    }
    const analysis::TrajectoryView view{states, 1, rollouts.num_rollouts(), rollouts.num_steps(),
                                        rollouts.num_states()};
    const double share = analysis::Metrics(rollouts).goal(view, *data.info.goal)(0);
    return fmt::format("{:.0f} of {}", share * static_cast<double>(rollouts.num_rollouts()),
                       rollouts.num_rollouts());
  };
  std::string text = fmt::format("P({}): of the target's own rollouts {}",
                                 data.info.goal->description, reached(target));
  if (held_out) text += fmt::format(", of the held-out ones {}", reached(*held_out));
  table.footnote(text);
}

Table rounds_table(const ReportData& data) {
  const auto& metrics = data.plan.study.evaluate.metrics;
  const std::string metric =
      std::find(metrics.begin(), metrics.end(), "rmse") != metrics.end() ? "rmse" : metrics.front();
  Table table;
  table.name = "rounds";
  table.caption = title_of(data, metric) + " of posterior samples after each round, all seeds.";
  table.row_header = "Method";
  table.command = data.plan.command;
  const Index most_rounds = add_round_columns(table, data);
  for (const std::string& method : data.methods) {
    Row row{method, {}};
    for (Index round = 1; round <= most_rounds; ++round) {
      const auto runs = data.runs_of(method, round);
      row.cells.push_back(runs.empty() ? Cell()
                                       : cell_of(table, analysis::summarize(pooled(runs, metric))));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace npdr::pipeline
