#include "pipeline/report/figure_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "analysis/interval_plot.h"
#include "analysis/pair_plot.h"
#include "core/quantile.h"

namespace npdr::pipeline {

std::vector<std::string> drawn_methods(std::vector<std::string> methods) {
  methods.resize(std::min(methods.size(), analysis::kMaxMethods));
  return methods;
}

std::vector<std::string> drawn_methods_with(const ReportData& data, Check check) {
  std::vector<std::string> methods = drawn_methods(data.methods);
  std::erase_if(methods, [&](const auto& method) { return !data.checks_of(method).has(check); });
  return methods;
}

std::string left_out_methods(const std::vector<std::string>& methods) {
  const std::size_t drawn = drawn_methods(methods).size();
  if (drawn == methods.size()) return "";
  return fmt::format(" The first {} of {} methods.", drawn, methods.size());
}

std::vector<Index> shown_parameters(const Study& study) {
  std::vector<Index> shown;
  if (study.report.parameters.empty()) {
    shown.resize(std::min<std::size_t>(study.prior.size(), analysis::kMaxPairParameters));
    std::iota(shown.begin(), shown.end(), Index{0});
  }
  for (const std::string& name : study.report.parameters) {
    const auto found = std::ranges::find(study.prior, name, &inference::Marginal::name);
    shown.push_back(found - study.prior.begin());
  }
  return shown;
}

std::string left_out_parameters(const Study& study) {
  const std::size_t shown = shown_parameters(study).size();
  if (shown == study.prior.size()) return "";
  return fmt::format(" {} of {} parameters.", shown, study.prior.size());
}

std::vector<analysis::MarkedPoint> marked_points(const ReportData& data) {
  using analysis::LegendMark, analysis::LineStyle;
  std::vector<analysis::MarkedPoint> points;
  const auto mark = [&](const std::string& name, LegendMark shape, const char* color,
                        LineStyle line) {
    const auto found = std::ranges::find(data.baseline.points, name, &BaselinePoint::name);
    if (found != data.baseline.points.end()) {
      points.push_back({name, found->theta, shape, color, line});
    }
  };
  mark("nominal", LegendMark::triangle, analysis::kNominalColor, LineStyle::dashed);
  mark("truth", LegendMark::diamond, analysis::kTruthColor, LineStyle::solid);
  const auto& references = data.plan.study.references;
  for (std::size_t i = 0; i < std::min(references.size(), analysis::kMaxReferences); ++i) {
    mark(references[i].name, LegendMark::square, analysis::kReferenceColors[i],
         LineStyle::dash_dotted);
  }
  return points;
}

RowMatrix interval_quantiles(const RowMatrix& samples) {
  RowMatrix quantiles(samples.cols(), std::ssize(analysis::kIntervalLevels));
  for (Index d = 0; d < samples.cols(); ++d) {
    const std::vector<double> sorted = sorted_finite(samples.col(d));
    Index k = 0;
    for (const double level : analysis::kIntervalLevels) {
      quantiles(d, k++) = quantile_of_sorted(sorted, level);
    }
  }
  return quantiles;
}

const Diagnosis& first_diagnosis(const ReportData& data, const std::string& method) {
  return data.diagnoses_of(method).front()->result;
}

}  // namespace npdr::pipeline
