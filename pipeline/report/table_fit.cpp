#include <fmt/format.h>

#include <algorithm>

#include "analysis/metrics.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

using Runs = std::vector<const EvaluatedRun*>;

void note_failed_rows(Table& table, const ReportData& data) {
  for (const std::string& method : data.methods) {
    Index used = 0, failed = 0;
    for (const EvaluatedRun* run : data.runs_of(method)) {
      used += run->notes.rows.used;
      failed += run->notes.rows.failed;
    }
    if (failed == 0) continue;
    const bool is_refined =
        data.plan.study.method(method).algorithm.kind == inference::Algorithm::refine;
    table.footnote(
        fmt::format("{}: {} of {} simulations failed and {}", method, failed, used + failed,
                    is_refined ? "count as impossible parameters" : "were left out of training"));
  }
}

// Nothing keeps a regression's samples inside of the prior.
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

std::string rollouts_at_goal(const ReportData& data, const Target& target) {
  std::vector<float> states;  // as if they had been simulated
  for (const Rollout& rollout : target.rollouts) {
    const RowMatrixF after = rollout.states.bottomRows(rollout.num_steps()).cast<float>();
    states.insert(states.end(), after.data(), after.data() + after.size());
  }
  const analysis::TrajectoryView view{states, 1, target.num_rollouts(), target.num_steps(),
                                      target.num_states()};
  const double share = analysis::Metrics(target).goal(view, *data.info.goal)(0);
  return fmt::format("{:.0f} of {}", share * static_cast<double>(target.num_rollouts()),
                     target.num_rollouts());
}

// Counts the target's rollouts, and the held-out ones, that reach the goal themselves.
void note_recorded_goal(Table& table, const ReportData& data) {
  if (std::ranges::count(data.plan.study.evaluate.metrics, Metric::goal) == 0) return;
  std::string text = fmt::format("P({}): of the target's own rollouts {}",
                                 data.info.goal->description, rollouts_at_goal(data, data.target));
  if (data.held_out) {
    text += fmt::format(", of the held-out ones {}", rollouts_at_goal(data, *data.held_out));
  }
  table.footnote(text);
}

// Columns: ours, published, then the prior and single parameter vectors.
void add_fit_columns(Table& table, const ReportData& data) {
  for (const std::string& method : data.methods) {
    table.columns.push_back({method, false});
    if (!data.plan.study.method(method).published.empty()) table.columns.push_back({method, true});
  }
  add_columns(table, baseline_names(data));
}

// Simulations that went well, but have no distance: there is nothing to measure it in.
bool has_no_scale(const EvaluatedRun& run, const std::string& metric) {
  const auto& x = run.evaluation.x;
  return metric == name_of(Metric::distance) && x && x->array().isFinite().any() &&
         run.evaluation.metrics.at(metric).array().isNaN().all();
}

// Samples of a metric, of `runs` or beside them.
Cell fit_cell(Table& table, const Runs& runs, const std::string& metric, const Vector& samples) {
  if (!has_no_scale(*runs.front(), metric)) return cell_of(table, analysis::summarize(samples));
  Cell cell("none");
  cell.notes.push_back(table.footnote("no feature varies over the simulations of the prior"));
  return cell;
}

Row fit_row(Table& table, const ReportData& data, const std::string& metric) {
  Row row{title_of(data, metric), {}};
  for (const std::string& method : data.methods) {
    const Runs runs = data.runs_of(method);
    row.cells.push_back(fit_cell(table, runs, metric, pooled(runs, metric_samples(metric))));
    const auto& published = data.plan.study.method(method).published;
    if (published.empty()) continue;
    const auto figure = published.find(metric);
    row.cells.push_back(figure == published.end()
                            ? Cell()
                            : analysis::MeanStd{figure->second.mean, figure->second.std, 0});
  }
  if (const auto& prior = data.baseline.prior) {
    const Runs any = data.runs_of(data.methods.front());
    row.cells.push_back(fit_cell(table, any, metric, prior->metrics.at(metric)));
  }
  for (const BaselinePoint& point : data.baseline.points) {
    row.cells.emplace_back(point.metrics.at(metric));
  }
  return row;
}

Row seed_means_row(Table& table, const ReportData& data, const std::string& metric) {
  Row row{title_of(data, metric) + ", seed means", {}};
  for (const std::string& method : data.methods) {
    row.cells.push_back(
        cell_of_seeds(table, summary_of_means(data.runs_of(method), metric_samples(metric))));
    if (!data.plan.study.method(method).published.empty()) row.cells.emplace_back();
  }
  row.cells.resize(row.cells.size() + baseline_names(data).size());
  return row;
}

// Features have what noise their simulator gives them.
std::string noise_text(const Study& study) {
  const ObservationNoise& noise = study.observation_noise;
  if (noise.is_silent()) return study.source().gives_motion ? " Without observation noise." : "";
  return fmt::format(" Observation noise: {}; {}.", to_text(noise),
                     noise.redraw ? "redrawn in every epoch" : "drawn once per simulation");
}

bool has_fit_table(const ReportData& data) {
  return !data.methods.empty() && data.plan.study.source().simulates;
}

Table make_fit_table(const ReportData& data) {
  const Study& study = data.plan.study;
  Table table = empty_table(
      fmt::format("Fit of posterior samples to the target domain: mean and standard deviation over "
                  "{} samples of {}.{}",
                  study.evaluate.num_samples, data.each_experiment(), noise_text(study)),
      "Metric", {});
  add_fit_columns(table, data);
  for (const std::string& metric : measured_names(study)) {
    table.rows.push_back(fit_row(table, data, metric));
    if (data.seeds.size() > 1) table.rows.push_back(seed_means_row(table, data, metric));
  }
  note_failed_rows(table, data);
  note_regressions(table, data);
  if (study.source().predicts_features()) {
    table.footnote(
        "Distance to x_o: root of the mean over features of ((x - x_o) / s)², s the standard "
        "deviation of the feature over simulations of the prior; features that span orders of "
        "magnitude after a logarithm of a kind");
  }
  note_recorded_goal(table, data);
  return table;
}

}  // namespace

/// Fit of each method's posterior samples to the target domain: the twin of Tables 2 and A2,
/// with the published figures, the prior, the nominal parameters and the floor beside them.
TableEntry fit_table() { return {"fit", Section::fit, has_fit_table, make_fit_table}; }

}  // namespace npdr::pipeline
