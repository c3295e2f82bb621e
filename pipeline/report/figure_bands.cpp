#include <algorithm>

#include "analysis/calibration_plot.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// Whose predictions of which rollouts.
struct Panel {
  const char* title;
  std::optional<PredictionScores> RolloutScores::*scores;
  RowMatrix PredictionScores::*coverage;
};
constexpr Panel kPanels[] = {
    {"target rollouts", &RolloutScores::seen, &PredictionScores::coverage},
    {"target rollouts, with noise", &RolloutScores::seen, &PredictionScores::noisy_coverage},
    {"held out", &RolloutScores::held_out, &PredictionScores::coverage},
    {"held out, with noise", &RolloutScores::held_out, &PredictionScores::noisy_coverage}};

// Mean over channels at each level; none: there are no such predictions.
Vector curve_of(const EvaluatedRun& run, const Panel& panel) {
  const auto& scores = run.evaluation.scores.*panel.scores;
  if (!scores) return {};
  return ((*scores).*panel.coverage).rowwise().mean();
}

bool has_band_figure(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.evaluation.scores.seen.has_value(); });
}

analysis::ReportFigure make_band_figure(const ReportData& data,
                                        const std::filesystem::path& folder) {
  analysis::CoveragePlot plot{"bands", {}};
  const Eigen::Map<const Vector> levels(kBandLevels.data(), std::ssize(kBandLevels));
  for (const Panel& kind : kPanels) {
    analysis::CoveragePanel panel{kind.title, {}};
    for (const std::string& method : drawn_methods(data.methods)) {
      const Vector curve = curve_of(*data.runs_of(method).front(), kind);
      if (curve.size() > 0) panel.curves.push_back({method, levels, curve});
    }
    if (!panel.curves.empty()) plot.panels.push_back(std::move(panel));
  }
  return {analysis::write_coverage_plot(plot, folder).svg,
          "Share of the recorded states within the samples' central bands of each level, mean over "
          "channels, seed " +
              std::to_string(data.seeds.front()) +
              ". Below the diagonal: too sure of itself, above: too vague." +
              noiseless_bands_text(data.plan.study) + left_out_methods(data.methods)};
}

}  // namespace

/// Coverage of predictive bands by their level, of the first seed.
FigureEntry band_figure() { return {Section::fit, has_band_figure, make_band_figure}; }

}  // namespace npdr::pipeline
