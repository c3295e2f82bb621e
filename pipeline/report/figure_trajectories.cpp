#include <fmt/format.h>

#include "analysis/trajectory_plot.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

analysis::ReportFigure make(const ReportData& data, const std::filesystem::path& folder) {
  analysis::TrajectoryPlot plot;
  plot.name = "trajectories";
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.predictions.push_back({method, *data.runs_of(method).front()->evaluation.bands});
  }
  return {analysis::write_trajectory_plot(plot, data.target, folder).svg,
          fmt::format("Recorded states, predictive median and 90 % band of seed {}.{}",
                      data.seeds.front(), left_out_methods(data.methods))};
}

bool exists(const ReportData& data) {
  return has_posteriors(data) && data.plan.study.source().gives_motion;
}

}  // namespace

/// Recorded and predicted trajectories of the first seed.
FigureEntry trajectory_figure() { return {Section::fit, exists, make}; }

}  // namespace npdr::pipeline
