#include <fmt/format.h>

#include <algorithm>

#include "analysis/metrics.h"
#include "analysis/path_plot.h"
#include "analysis/trajectory_plot.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

using RunsOfMethod = std::vector<const EvaluatedRun*>;

void note_failed_rows(const ReportData& data, std::vector<std::string>& notes) {
  for (const std::string& method : data.methods) {
    Index used = 0, failed = 0;
    for (const EvaluatedRun* run : data.runs_of(method)) {
      used += run->notes.rows.used;
      failed += run->notes.rows.failed;
    }
    if (failed == 0) continue;
    const bool is_refined =
        data.plan.study.method(method).algorithm.kind == inference::Algorithm::refine;
    notes.push_back(
        fmt::format("{}: {} of {} simulations failed and {}", method, failed, used + failed,
                    is_refined ? "count as impossible parameters" : "were left out of training"));
  }
}

// Nothing keeps a regression's samples inside of the prior.
void note_regressions(const ReportData& data, std::vector<std::string>& notes) {
  for (const std::string& method : data.methods) {
    RegressionCounts sum;
    for (const EvaluatedRun* run : data.runs_of(method)) {
      const RegressionCounts counts = run->notes.regression.value_or(RegressionCounts{});
      sum.samples += counts.samples;
      sum.non_physical += counts.non_physical;
      sum.outside_prior += counts.outside_prior;
    }
    if (sum.samples == 0) continue;
    notes.push_back(
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
void note_recorded_goal(const ReportData& data, std::vector<std::string>& notes) {
  if (std::ranges::count(data.plan.study.evaluate.metrics, Metric::goal) == 0) return;
  notes.push_back(fmt::format("P({}): of the target's own rollouts {}", data.info.goal->description,
                              rollouts_at_goal(data, data.target)));
  if (!data.held_out) return;
  notes.back() += fmt::format(", of the held-out ones {}", rollouts_at_goal(data, *data.held_out));
}

std::vector<std::string> fit_notes(const ReportData& data) {
  std::vector<std::string> notes;
  note_failed_rows(data, notes);
  note_regressions(data, notes);
  if (data.plan.study.source().predicts_features()) {
    notes.emplace_back(
        "Distance to x_o: root of the mean over features of ((x - x_o) / s)². s is the standard "
        "deviation of the feature over simulations of the prior. Features that span orders of "
        "magnitude are first put on a logarithmic scale");
  }
  note_recorded_goal(data, notes);
  return notes;
}

// Simulations that went well, but have no distance: there is nothing to measure it in.
bool has_no_scale(const EvaluatedRun& run, const std::string& metric) {
  const auto& x = run.evaluation.x;
  return metric == name_of(Metric::distance) && x && x->array().isFinite().any() &&
         run.evaluation.metrics.at(metric).array().isNaN().all();
}

// Samples of a metric, of `runs` or beside them.
Cell fit_cell(const RunsOfMethod& runs, const std::string& metric, const Vector& samples) {
  if (!has_no_scale(*runs.front(), metric)) return cell_of(analysis::summarize(samples));
  Cell cell("none");
  cell.notes.emplace_back("no feature varies over the simulations of the prior");
  return cell;
}

// Features have what noise their simulator gives them.
std::string noise_text(const Study& study) {
  const ObservationNoise& noise = study.observation_noise;
  if (noise.is_silent()) return study.source().gives_motion ? " Without observation noise." : "";
  return fmt::format(" Observation noise: {}; {}.", to_text(noise),
                     noise.redraw ? "redrawn in every epoch" : "drawn once per simulation");
}

// A metric over all samples, or the means of the seeds.
struct FitRow {
  std::string metric;
  bool is_of_seed_means;
};

std::vector<FitRow> fit_rows(const ReportData& data) {
  std::vector<FitRow> rows;
  for (const std::string& metric : measured_names(data.plan.study)) {
    rows.push_back({metric, false});
    if (data.seeds.size() > 1) rows.push_back({metric, true});
  }
  return rows;
}

// Ours, and beside it what was published.
void add_method(const ReportData& data, const std::string& method, TableOf<FitRow>& table) {
  table.add_compared(method, [runs = data.runs_of(method)](const FitRow& row) {
    const auto samples = metric_samples(row.metric);
    return row.is_of_seed_means ? cell_of_seeds(summary_of_means(runs, samples))
                                : fit_cell(runs, row.metric, pooled(runs, samples));
  });
  const auto& published = data.plan.study.method(method).published;
  if (published.empty()) return;
  table.add(method + ", published", [&](const FitRow& row) -> Cell {
    const auto figure = published.find(row.metric);
    if (row.is_of_seed_means || figure == published.end()) return {};
    return analysis::MeanStd{figure->second.mean, figure->second.std, 0};
  });
}

std::optional<ReportedFigure> figure_of_bands(const ReportData& data, const char* name,
                                              const char* rollouts, const Target* target,
                                              std::optional<analysis::Bands> Evaluation::*bands) {
  if (!has_rollout_scores(data) || target == nullptr) return std::nullopt;
  analysis::TrajectoryPlot plot{.name = name};
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.predictions.push_back({method, *(data.runs_of(method).front()->evaluation.*bands)});
  }
  return {{figure_of(plot, *target),
           fmt::format("Recorded states{}, predictive median and 90 % band of seed {}.", rollouts,
                       data.seeds.front())}};
}

constexpr Index kDrawnSamples = 30;  // of each method

std::vector<RowMatrix> recorded_paths(const Target& target) {
  std::vector<RowMatrix> paths;
  for (const Rollout& rollout : target.rollouts) paths.push_back(rollout.states.leftCols(2));
  return paths;
}

analysis::PathPrediction predict(const std::string& method, const Predictor& predictor,
                                 const ParameterMap& parameters, const sim::Simulator& simulator,
                                 const RowMatrix& theta) {
  const RowMatrix complete = parameters.complete(theta);
  const sim::Trajectories trajectories = predictor.simulate(complete);
  analysis::PathPrediction prediction{method, {}, {}};
  for (Index i = 0; i < complete.rows(); ++i) {
    for (const Outline& outline : simulator.outlines(complete.row(i).transpose())) {
      if (!outline.is_fixed) prediction.outlines.push_back(outline.points);
    }
    if (trajectories.status[static_cast<std::size_t>(i)] != sim::RolloutStatus::ok) continue;
    for (Index h = 0; h < trajectories.num_rollouts; ++h) {
      prediction.paths.push_back(trajectories.rollout(i, h).leftCols(2).cast<double>());
    }
  }
  return prediction;
}

std::vector<RowMatrix> fixed_outlines(const ReportData& data) {
  const auto simulator = sim::make_simulator(data.plan.study.simulator);
  std::vector<RowMatrix> fixed;
  for (const Outline& outline : simulator->outlines(data.plan.source->parameters().nominal())) {
    if (outline.is_fixed) fixed.push_back(outline.points);
  }
  return fixed;
}

}  // namespace

/// Fit of each method's posterior samples to the target domain: the twin of Tables 2 and A2,
/// with the published figures, the prior, the nominal parameters and the floor beside them.
std::optional<Table> fit_table(const ReportData& data) {
  const Study& study = data.plan.study;
  if (!has_posteriors(data) || !study.source().simulates) return std::nullopt;
  TableOf<FitRow> table{
      .caption = fmt::format("Fit of posterior samples to the target domain: mean and standard "
                             "deviation over {} samples of {}.{}",
                             study.evaluate.num_samples, data.each_experiment(), noise_text(study)),
      .row_header = "Metric",
      .rows = fit_rows(data),
      .label =
          [&](const FitRow& row) {
            return title_of(data, row.metric) + (row.is_of_seed_means ? ", seed means" : "");
          },
      .ideal = [](const FitRow& row) { return ideal_of(row.metric); },
      .last_notes = fit_notes(data)};
  for (const std::string& method : data.methods) add_method(data, method, table);
  if (const auto& prior = data.baseline.prior) {
    table.add("prior", [&](const FitRow& row) {
      const RunsOfMethod any = data.runs_of(data.methods.front());
      return row.is_of_seed_means ? Cell()
                                  : fit_cell(any, row.metric, prior->metrics.at(row.metric));
    });
  }
  for (const BaselinePoint& point : data.baseline.points) {
    table.add(point.name, [&](const FitRow& row) {
      return row.is_of_seed_means ? Cell() : Cell(point.metrics.at(row.metric));
    });
  }
  return table.make();
}

/// Recorded and predicted trajectories of the first seed.
std::optional<ReportedFigure> trajectory_figure(const ReportData& data) {
  return figure_of_bands(data, "trajectories", "", &data.target, &Evaluation::bands);
}

/// The same of the rollouts that were held out.
std::optional<ReportedFigure> held_out_figure(const ReportData& data) {
  return figure_of_bands(data, "trajectories_held_out",
                         " of held-out rollouts, which inference hasn't seen",
                         data.held_out ? &*data.held_out : nullptr, &Evaluation::held_out_bands);
}

/// Paths and shapes of a system that moves on a plane, seen from above: at posterior samples of the
/// first seed, against the target and the held-out rollouts.
std::optional<ReportedFigure> path_figure(const ReportData& data) {
  if (!has_posteriors(data) || !data.plan.study.source().is_built_in) return std::nullopt;
  const std::vector<RowMatrix> fixed = fixed_outlines(data);
  if (fixed.empty()) return std::nullopt;
  const Predictor predictor(data.plan, data.target, "");
  const auto simulator = sim::make_simulator(data.plan.study.simulator);
  analysis::PathPlot plot;
  plot.name = "paths";
  plot.unit = data.target.state_channels.front().unit;
  plot.fixed = fixed;
  plot.recorded = recorded_paths(data.target);
  if (data.held_out) plot.held_out = recorded_paths(*data.held_out);
  for (const std::string& method : drawn_methods(data.methods)) {
    const RowMatrix& theta = data.runs_of(method).front()->evaluation.theta;
    plot.predictions.push_back(predict(method, predictor, data.plan.source->parameters(),
                                       *simulator,
                                       theta.topRows(std::min(kDrawnSamples, theta.rows()))));
  }
  return {{figure_of(plot),
           fmt::format("Seen from above: the target's paths, and paths and shapes at the first {} "
                       "posterior samples of seed {}. Black: what no parameter moves.",
                       kDrawnSamples, data.seeds.front())}};
}

}  // namespace npdr::pipeline
