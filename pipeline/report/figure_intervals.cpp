#include <fmt/format.h>

#include <algorithm>

#include "analysis/interval_plot.h"
#include "analysis/report.h"
#include "core/normal.h"
#include "inference/prior.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// The prior's distribution function at theta (n, D), of the shown parameters.
RowMatrix place_in_prior(const inference::Prior& prior, const RowMatrix& theta,
                         const std::vector<Index>& shown) {
  return prior.to_normal(theta)(Eigen::all, shown).unaryExpr([](double u) {
    return normal_cdf(u);
  });
}

// "pole_mass [kg]", and a line for each method: "NPE: 0.812, 90 % in [0.31, 1.02]".
std::string tip_of(const ReportData& data, Index d) {
  const inference::Marginal& parameter = data.plan.study.prior[static_cast<std::size_t>(d)];
  std::string words = fmt::format("{} [{}]", parameter.name, parameter.unit);
  for (const std::string& method : data.methods) {
    const RowMatrix quantiles = interval_quantiles(unwrapped_samples_of(data, method, d));
    words += fmt::format("\n{}: {:.3g}, 90 % in [{:.3g}, {:.3g}]", method, quantiles(0, 2),
                         quantiles(0, 0), quantiles(0, 4));
  }
  return words;
}

// Samples of all seeds; a periodic parameter's lie on the side of their mean, up to the border.
RowMatrix samples_within(const ReportData& data, const std::string& method) {
  RowMatrix theta;
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    const inference::Marginal& parameter = data.plan.study.prior[static_cast<std::size_t>(d)];
    const Vector samples = unwrapped_samples_of(data, method, d);
    theta.conservativeResize(samples.size(), d + 1);
    theta.col(d) = samples.cwiseMax(parameter.lower()).cwiseMin(parameter.upper());
  }
  return theta;
}

analysis::IntervalPlot plot_of(const ReportData& data) {
  const Study& study = data.plan.study;
  const inference::Prior prior(study.prior);
  const std::vector<Index> shown = shown_parameters(study);
  analysis::IntervalPlot plot;
  plot.name = "intervals";
  plot.title = "place in the prior: share of it that lies below";
  for (const Index d : shown) {
    plot.parameters.push_back(study.prior[static_cast<std::size_t>(d)].name);
    plot.tips.push_back(tip_of(data, d));
  }
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.sets.push_back(
        {method, interval_quantiles(place_in_prior(prior, samples_within(data, method), shown))});
  }
  plot.points = marked_points(data);
  for (analysis::MarkedPoint& point : plot.points) {
    point.place = place_in_prior(prior, point.place.transpose(), shown).transpose().eval();
  }
  return plot;
}

std::string note_on_periods(const ReportData& data) {
  const std::vector<Index> shown = shown_parameters(data.plan.study);
  const bool has_any = std::ranges::any_of(shown, [&](Index d) { return data.period_of(d) > 0.0; });
  return has_any ? " Of a periodic parameter, up to the border of its range." : "";
}

}  // namespace

/// Credible intervals of each method's posterior within the prior.
std::optional<ReportedFigure> interval_figure(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  const analysis::IntervalPlot plot = plot_of(data);
  analysis::IntervalPlot narrow = plot;
  narrow.name += "_narrow";
  narrow.width = analysis::kNarrowWidth;
  return {{figure_of(plot),
           fmt::format("What the posteriors say of each parameter, all seeds: median, 50 % "
                       "interval (thick) and 90 % interval, within what the prior allows "
                       "(grey).{}{}",
                       note_on_periods(data), left_out_parameters(data.plan.study)),
           figure_of(narrow)}};
}

}  // namespace npdr::pipeline
