#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "analysis/figure.h"
#include "analysis/pair_plot.h"
#include "core/quantile.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

// Values of a parameter as they are drawn; NaN where a log has none.
Vector drawn(const inference::Marginal& m, const Vector& values) {
  return m.is_log() ? Vector(values.array().log10()) : values;
}

// Where the methods' samples are, within the prior; an unbounded one is shown over three
// deviations.
analysis::PairParameter axis_of(const analysis::PairPlot& plot, const inference::Marginal& m,
                                Index d) {
  const auto [low, high] = m.central_range(3.0);
  const Vector most = drawn(m, Vector{{low, high}});
  analysis::Range range;
  for (const analysis::SampleSet& set : plot.sets) {
    const std::vector<double> sorted = sorted_finite(set.samples.col(d));
    if (sorted.empty()) continue;
    for (const double level : {0.005, 0.995}) range.add(quantile_of_sorted(sorted, level));
  }
  range = range.widened(0.15);
  const double lower = std::clamp(range.lower, most(0), most(1));
  const double upper = std::clamp(range.upper, most(0), most(1));
  const std::string label = m.is_log() ? "log₁₀ " + m.name : m.name;
  if (!(lower < upper)) return {label, m.unit, most(0), most(1)};
  return {label, m.unit, lower, upper};
}

}  // namespace

/// Pair plot of the first seed's posterior samples of each method.
std::optional<ReportedFigure> pair_figure(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  analysis::PairPlot plot;
  plot.name = "pair_plot";
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.sets.push_back({method, data.runs_of(method).front()->evaluation.theta});
  }
  plot.points = marked_points(data);
  Index d = 0;
  for (const inference::Marginal& m : data.plan.study.prior) {
    for (analysis::SampleSet& set : plot.sets) {
      set.samples.col(d) = drawn(m, set.samples.col(d)).eval();
    }
    for (analysis::MarkedPoint& point : plot.points) {
      point.place(d) = drawn(m, point.place.segment(d, 1))(0);
    }
    plot.parameters.push_back(axis_of(plot, m, d));
    ++d;
  }
  plot.selection = shown_parameters(data.plan.study);
  return {{figure_of(plot), fmt::format("Posterior samples of seed {}, where they are.{}",
                                        data.seeds.front(), left_out_parameters(data.plan.study))}};
}

}  // namespace npdr::pipeline
