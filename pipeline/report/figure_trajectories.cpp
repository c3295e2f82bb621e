#include <fmt/format.h>

#include "analysis/trajectory_plot.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

analysis::ReportFigure draw(const ReportData& data, const std::filesystem::path& folder,
                            const char* name, const char* rollouts, const Target& target,
                            std::optional<analysis::Bands> Evaluation::*bands) {
  analysis::TrajectoryPlot plot;
  plot.name = name;
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.predictions.push_back({method, *(data.runs_of(method).front()->evaluation.*bands)});
  }
  return {analysis::write_trajectory_plot(plot, target, folder).svg,
          fmt::format("Recorded states{}, predictive median and 90 % band of seed {}.{}", rollouts,
                      data.seeds.front(), left_out_methods(data.methods))};
}

bool has_trajectory_figure(const ReportData& data) {
  return has_posteriors(data) && data.plan.study.source().gives_motion;
}

bool has_held_out_figure(const ReportData& data) {
  return has_trajectory_figure(data) && data.held_out.has_value();
}

analysis::ReportFigure make_trajectory_figure(const ReportData& data,
                                              const std::filesystem::path& folder) {
  return draw(data, folder, "trajectories", "", data.target, &Evaluation::bands);
}

analysis::ReportFigure make_held_out_figure(const ReportData& data,
                                            const std::filesystem::path& folder) {
  return draw(data, folder, "trajectories_held_out",
              " of held-out rollouts, which inference hasn't seen", *data.held_out,
              &Evaluation::held_out_bands);
}

}  // namespace

/// Recorded and predicted trajectories of the first seed.
FigureEntry trajectory_figure() {
  return {Section::fit, has_trajectory_figure, make_trajectory_figure};
}

/// The same of the rollouts that were held out.
FigureEntry held_out_figure() { return {Section::fit, has_held_out_figure, make_held_out_figure}; }

}  // namespace npdr::pipeline
