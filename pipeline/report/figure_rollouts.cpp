#include <fmt/format.h>

#include <algorithm>

#include "analysis/path_plot.h"
#include "analysis/trajectory_plot.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

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
