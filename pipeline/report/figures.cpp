#include "pipeline/report/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "analysis/figure.h"
#include "analysis/pair_plot.h"
#include "analysis/trajectory_plot.h"

namespace npdr::pipeline {
namespace {

const BaselinePoint* find_point(const ReportData& data, const std::string& name) {
  for (const BaselinePoint& point : data.baseline) {
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

std::vector<Index> shown_parameters(const Study& study) {
  std::vector<Index> shown;
  if (study.report.parameters.empty()) {
    shown.resize(std::min<std::size_t>(study.prior.size(), analysis::kMaxPairParameters));
    std::iota(shown.begin(), shown.end(), Index{0});
  }
  for (const std::string& name : study.report.parameters) {
    const auto found = std::find_if(study.prior.begin(), study.prior.end(),
                                    [&](const auto& m) { return m.name == name; });
    shown.push_back(found - study.prior.begin());
  }
  return shown;
}

}  // namespace

std::span<const std::string> drawn_methods(const ReportData& data) {
  return std::span(data.methods).first(std::min(data.methods.size(), analysis::kMaxMethods));
}

std::string left_out_methods(const ReportData& data) {
  const std::size_t drawn = drawn_methods(data).size();
  if (drawn == data.methods.size()) return "";
  return fmt::format(" The first {} of {} methods.", drawn, data.methods.size());
}

std::string left_out_parameters(const Study& study) {
  const std::size_t shown = shown_parameters(study).size();
  if (shown == study.prior.size()) return "";
  return fmt::format(" {} of {} parameters.", shown, study.prior.size());
}

std::filesystem::path write_pair_figure(const ReportData& data,
                                        const std::filesystem::path& folder) {
  analysis::PairPlot plot;
  plot.name = "pair_plot";
  for (Index d = 0; d < static_cast<Index>(data.plan.study.prior.size()); ++d) {
    plot.parameters.push_back(axis_of(data, d));
  }
  for (const std::string& method : drawn_methods(data)) {
    plot.sets.push_back({method, data.runs_of(method).front()->evaluation.theta});
  }
  plot.points = marked_points(data);
  plot.selection = shown_parameters(data.plan.study);
  return analysis::write_pair_plot(plot, folder).svg;
}

std::filesystem::path write_trajectory_figure(const ReportData& data, const Target& target,
                                              const std::filesystem::path& folder) {
  analysis::TrajectoryPlot plot;
  plot.name = "trajectories";
  for (const std::string& method : drawn_methods(data)) {
    plot.predictions.push_back({method, *data.runs_of(method).front()->evaluation.bands});
  }
  return analysis::write_trajectory_plot(plot, target, folder).svg;
}

}  // namespace npdr::pipeline
