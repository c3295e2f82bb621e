#include <fmt/format.h>

#include "analysis/trajectory_plot.h"
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

}  // namespace npdr::pipeline
