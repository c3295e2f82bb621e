#include <fmt/format.h>

#include "analysis/interval_plot.h"
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
    const RowMatrix samples = pooled(data.runs_of(method), [d](const EvaluatedRun* run) -> Vector {
      return run->evaluation.theta.col(d);
    });
    const RowMatrix quantiles = interval_quantiles(samples);
    words += fmt::format("\n{}: {:.3g}, 90 % in [{:.3g}, {:.3g}]", method, quantiles(0, 2),
                         quantiles(0, 0), quantiles(0, 4));
  }
  return words;
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
    RowMatrix samples(0, std::ssize(shown));
    for (const EvaluatedRun* run : data.runs_of(method)) {
      const RowMatrix place = place_in_prior(prior, run->evaluation.theta, shown);
      samples.conservativeResize(samples.rows() + place.rows(), Eigen::NoChange);
      samples.bottomRows(place.rows()) = place;
    }
    plot.sets.push_back({method, interval_quantiles(samples)});
  }
  for (const MarkedPoint& point : marked_points(data)) {
    const RowMatrix place = place_in_prior(prior, point.theta.transpose(), shown);
    plot.points.push_back({point.name, place.transpose(), point.mark, point.color});
  }
  return plot;
}

analysis::ReportFigure make(const ReportData& data, const std::filesystem::path& folder) {
  analysis::IntervalPlot plot = plot_of(data);
  const std::filesystem::path svg = analysis::write_interval_plot(plot, folder).svg;
  plot.name += "_narrow";
  plot.width = analysis::kNarrowWidth;
  return {svg,
          fmt::format("What the posteriors say of each parameter, all seeds: median, 50 % interval "
                      "(thick) and 90 % interval, within what the prior allows (grey).{}{}",
                      left_out_methods(data.methods), left_out_parameters(data.plan.study)),
          analysis::write_interval_plot(plot, folder).svg};
}

}  // namespace

/// Credible intervals of each method's posterior within the prior.
FigureEntry interval_figure() { return {Section::posteriors, has_posteriors, make}; }

}  // namespace npdr::pipeline
