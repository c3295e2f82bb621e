#include <fmt/format.h>

#include "analysis/calibration_plot.h"
#include "pipeline/config/check.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// The drawn methods to which a check means something.
std::vector<std::string> drawn_methods_with(const ReportData& data, Check check) {
  std::vector<std::string> methods = drawn_methods(data.methods);
  std::erase_if(methods, [&](const auto& method) { return !data.checks_of(method).has(check); });
  return methods;
}

// The first seed's checks of a method.
const Diagnosis& first_diagnosis(const ReportData& data, const std::string& method) {
  return data.diagnoses_of(method).front()->result;
}

// Adds a panel with the curves that methods have.
template <class CurveOf>
void add_panel(const ReportData& data, const char* title, const CurveOf& curve_of,
               analysis::CoveragePlot& plot) {
  analysis::CoveragePanel panel{title, {}};
  for (const std::string& method : drawn_methods(data.methods)) {
    analysis::CoverageCurve curve = curve_of(method);
    curve.method = method;
    if (curve.level.size() > 0) panel.curves.push_back(std::move(curve));
  }
  if (!panel.curves.empty()) plot.panels.push_back(std::move(panel));
}

}  // namespace

/// Histograms of simulation-based calibration's ranks, of the first seed.
std::optional<ReportedFigure> rank_figure(const ReportData& data) {
  const std::vector<std::string> methods = drawn_methods_with(data, Check::sbc);
  if (methods.empty()) return std::nullopt;
  analysis::RankPlot plot;
  plot.name = "sbc_ranks";
  for (const inference::Marginal& m : data.plan.study.prior) plot.parameters.push_back(m.name);
  for (const std::string& method : methods) {
    const SbcResult& sbc = *first_diagnosis(data, method).sbc;
    RowMatrix counts(static_cast<Index>(sbc.test.chi_square.front().counts.size()),
                     sbc.levels.cols());
    for (Index d = 0; d < counts.cols(); ++d) {
      const auto& bins = sbc.test.chi_square[static_cast<std::size_t>(d)].counts;
      for (Index b = 0; b < counts.rows(); ++b) {
        counts(b, d) = static_cast<double>(bins[static_cast<std::size_t>(b)]);
      }
    }
    plot.methods.push_back({method, counts});
  }
  return {{figure_of(plot),
           fmt::format("Ranks of the true parameters among posterior samples, seed {}: shares over "
                       "the even one. Gray: the band that holds 99 % of the bars of a posterior "
                       "without fault. Too narrow a posterior makes a U, too wide a one an arch, a "
                       "shifted one a slope.",
                       data.seeds.front())}};
}

/// Coverage of credible regions by their level, of the first seed.
std::optional<ReportedFigure> coverage_figure(const ReportData& data) {
  analysis::CoveragePlot plot{"coverage", {}};
  const auto add = [&](Check check, const char* title, auto result_of) {
    add_panel(
        data, title,
        [&](const std::string& method) -> analysis::CoverageCurve {
          if (!data.checks_of(method).has(check)) return {};
          const CoverageResult& result = *(first_diagnosis(data, method).*result_of);
          plot.num_truths = std::max(plot.num_truths, result.levels.size());
          return {"", result.coverage.level, result.coverage.coverage};
        },
        plot);
  };
  add(Check::coverage, "highest density", &Diagnosis::coverage);
  add(Check::tarp, "balls (TARP)", &Diagnosis::tarp);
  if (plot.panels.empty()) return std::nullopt;
  return {{figure_of(plot),
           fmt::format(
               "Share of true parameters within the credible regions of each level, seed {}. "
               "Of levels above 1/2: below the diagonal posteriors are too narrow, or beside the "
               "truth, above it too wide; of levels below 1/2 so are regions of highest density, "
               "and balls the other way round. Gray: 99 % of the curves of a posterior without "
               "fault, level by level.",
               data.seeds.front())}};
}

/// Coverage of predictive bands by their level, of the first seed.
std::optional<ReportedFigure> band_figure(const ReportData& data) {
  if (!has_rollout_scores(data)) return std::nullopt;
  analysis::CoveragePlot plot{"bands", {}};
  const Eigen::Map<const Vector> levels(kBandLevels.data(), std::ssize(kBandLevels));
  const auto add = [&](const char* title, auto scores_of, auto coverage_of) {
    add_panel(
        data, title,
        [&](const std::string& method) -> analysis::CoverageCurve {
          const auto& scores = data.runs_of(method).front()->evaluation.scores.*scores_of;
          if (!scores || ((*scores).*coverage_of).size() == 0) return {};
          return {"", levels, ((*scores).*coverage_of).rowwise().mean()};  // over channels
        },
        plot);
  };
  using S = PredictionScores;
  add("target rollouts", &RolloutScores::seen, &S::coverage);
  add("target rollouts, with noise", &RolloutScores::seen, &S::noisy_coverage);
  add("held out", &RolloutScores::held_out, &S::coverage);
  add("held out, with noise", &RolloutScores::held_out, &S::noisy_coverage);
  return {{figure_of(plot),
           fmt::format("Share of the recorded states within the samples' central bands of each "
                       "level, mean over channels, seed {}. Below the diagonal: too sure of "
                       "itself, above: too vague.{}",
                       data.seeds.front(), noiseless_bands_text(data.plan.study))}};
}

}  // namespace npdr::pipeline
