#include <fmt/format.h>

#include <algorithm>

#include "analysis/calibration_plot.h"
#include "pipeline/config/check.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

// A check that measures coverage, and which regions it is the coverage of.
struct CoverageCheck {
  Check check;
  const char* title;
  std::optional<CoverageResult> Diagnosis::*result;
};
constexpr CoverageCheck kCoverageChecks[] = {
    {Check::coverage, "highest density", &Diagnosis::coverage},
    {Check::tarp, "balls (TARP)", &Diagnosis::tarp}};

analysis::ReportFigure make_coverage_figure(const ReportData& data,
                                            const std::filesystem::path& folder) {
  analysis::CoveragePlot plot;
  plot.name = "coverage";
  for (const CoverageCheck& kind : kCoverageChecks) {
    analysis::CoveragePanel panel{kind.title, {}};
    for (const std::string& method : drawn_methods_with(data, kind.check)) {
      const CoverageResult& result = *(first_diagnosis(data, method).*kind.result);
      plot.num_truths = std::max(plot.num_truths, result.levels.size());
      panel.curves.push_back({method, result.coverage.level, result.coverage.coverage});
    }
    if (!panel.curves.empty()) plot.panels.push_back(std::move(panel));
  }
  return {analysis::write_coverage_plot(plot, folder).svg,
          fmt::format(
              "Share of true parameters within the credible regions of each level, seed {}. "
              "Of levels above 1/2: below the diagonal posteriors are too narrow, or beside the "
              "truth, above it too wide; of levels below 1/2 so are regions of highest density, "
              "and balls the other way round. Gray: 99 % of the curves of a posterior without "
              "fault, level by level.{}",
              data.seeds.front(), left_out_methods(data.methods))};
}

bool has_coverage_figure(const ReportData& data) {
  return std::ranges::any_of(kCoverageChecks, [&](const CoverageCheck& check) {
    return !drawn_methods_with(data, check.check).empty();
  });
}

}  // namespace

/// Coverage of credible regions by their level, of the first seed.
FigureEntry coverage_figure() {
  return {Section::diagnostics, has_coverage_figure, make_coverage_figure};
}

}  // namespace npdr::pipeline
