#include <fmt/format.h>

#include <algorithm>

#include "analysis/figure.h"
#include "analysis/pair_plot.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

const BaselinePoint* find_point(const ReportData& data, const std::string& name) {
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name == name) return &point;
  }
  return nullptr;
}

// The axis of parameter d; an unbounded prior is shown over three deviations.
analysis::PairParameter axis_of(const ReportData& data, Index d) {
  const inference::Marginal& m = data.plan.study.prior[static_cast<std::size_t>(d)];
  const auto [lower, upper] = m.central_range(3.0);
  return {m.name, m.unit, lower, upper};
}

// Nominal, truth and the first references.
std::vector<analysis::PairPoint> marked_points(const ReportData& data) {
  using analysis::LegendMark;
  std::vector<analysis::PairPoint> points;
  const auto mark = [&](const std::string& name, LegendMark shape, const char* color,
                        analysis::LineStyle style) {
    const BaselinePoint* point = find_point(data, name);
    if (point != nullptr) points.push_back({name, point->theta, shape, color, style});
  };
  mark("nominal", LegendMark::triangle, analysis::kNominalColor, analysis::LineStyle::dashed);
  mark("truth", LegendMark::diamond, analysis::kTruthColor, analysis::LineStyle::solid);
  const auto& references = data.plan.study.references;
  for (std::size_t i = 0; i < std::min(references.size(), analysis::kMaxReferences); ++i) {
    mark(references[i].name, LegendMark::square, analysis::kReferenceColors[i],
         analysis::LineStyle::dash_dotted);
  }
  return points;
}

analysis::ReportFigure make(const ReportData& data, const std::filesystem::path& folder) {
  analysis::PairPlot plot;
  plot.name = "pair_plot";
  for (Index d = 0; d < static_cast<Index>(data.plan.study.prior.size()); ++d) {
    plot.parameters.push_back(axis_of(data, d));
  }
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.sets.push_back({method, data.runs_of(method).front()->evaluation.theta});
  }
  plot.points = marked_points(data);
  plot.selection = shown_parameters(data.plan.study);
  return {
      analysis::write_pair_plot(plot, folder).svg,
      fmt::format("Posterior samples of seed {}. Limits are the prior's.{}{}", data.seeds.front(),
                  left_out_methods(data.methods), left_out_parameters(data.plan.study))};
}

bool exists(const ReportData& data) {
  return has_posteriors(data) && data.plan.study.prior.size() > 1;
}

}  // namespace

/// Pair plot of the first seed's posterior samples of each method.
FigureEntry pair_figure() { return {Section::posteriors, exists, make}; }

}  // namespace npdr::pipeline
