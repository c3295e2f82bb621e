#include <fmt/format.h>

#include "analysis/calibration_plot.h"
#include "pipeline/config/check.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {

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
                       "shifted one a slope.{}",
                       data.seeds.front(), left_out_methods(data.methods))}};
}

}  // namespace npdr::pipeline
