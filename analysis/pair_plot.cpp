#include "analysis/pair_plot.h"

#include <algorithm>

#include "analysis/density_curve.h"

namespace npdr::analysis {
namespace {

// Smaller with more parameters, so that fifteen still fit on a screen.
FigureSizes sizes_for(std::size_t num_parameters) {
  if (num_parameters <= 4) return {150.0, 150.0, 9.0, 11.0, 9.0};
  if (num_parameters <= 6) return {124.0, 124.0, 8.0, 10.5, 9.0};
  if (num_parameters <= 9) return {98.0, 98.0, 7.0, 9.5, 8.0};
  return {76.0, 76.0, 6.0, 8.5, 7.5};
}

// The plot without the parameters that aren't shown.
PairPlot select(const PairPlot& plot) {
  const auto count = static_cast<Index>(plot.parameters.size());
  const std::vector<Index> selection =
      check_selection(fmt::format("pair plot '{}': parameter", plot.name), plot.selection, count,
                      kMinPairParameters, kMaxPairParameters);
  PairPlot shown = plot;
  shown.parameters.clear();
  for (const Index d : selection) {
    shown.parameters.push_back(plot.parameters[static_cast<std::size_t>(d)]);
  }
  for (auto& [name, samples] : shown.sets) {
    require<ShapeError>(samples.cols() == count,
                        "pair plot '{}': samples of '{}' have {} columns for {} parameters",
                        plot.name, name, samples.cols(), count);
    samples = samples(Eigen::all, selection).eval();
  }
  for (MarkedPoint& point : shown.points) {
    require<ShapeError>(point.place.size() == count,
                        "pair plot '{}': '{}' has {} values for {} parameters", plot.name,
                        point.name, point.place.size(), count);
    point.place = point.place(selection).eval();
  }
  return shown;
}

// True when all samples of a parameter have the same value: a method took it as known.
bool is_constant(const Eigen::Ref<const Vector>& samples) {
  return samples.size() > 1 && (samples.array() == samples(0)).all();
}

// Evenly strided rows: chains of an MCMC sampler are all represented.
RowMatrix strided_rows(const RowMatrix& samples, Index count) {
  const Index rows = std::min(count, samples.rows());
  RowMatrix result(rows, samples.cols());
  for (Index i = 0; i < rows; ++i) result.row(i) = samples.row(i * samples.rows() / rows);
  return result;
}

// Columns 2 k and 2 k + 1: position and density of parameter k, over its peak.
RowMatrix marginal_densities(const std::vector<Axis>& axes, const RowMatrix& samples) {
  RowMatrix curves;
  for (Index k = 0; k < samples.cols(); ++k) {
    const Axis& axis = axes[static_cast<std::size_t>(k)];
    RowMatrix curve = density_curve(samples.col(k), axis.lower, axis.upper);
    const double peak = curve.col(1).maxCoeff();
    if (is_constant(samples.col(k)) || !(peak > 0.0)) {
      curve.col(1).setZero();
    } else {
      curve.col(1) /= peak;
    }
    curves.conservativeResize(curve.rows(), 2 * k + 2);
    curves.rightCols(2) = curve;
  }
  return curves;
}

std::string samples_table(std::size_t set) { return fmt::format("samples_{}", set + 1); }
std::string density_table(std::size_t set) { return fmt::format("density_{}", set + 1); }

// Density of a parameter. One that a method took as known has none: a line stands for it. Only the
// shape is shown, so the y axis has no ticks; what stands beside it is the parameter's title.
Panel marginal(const PairPlot& plot, Index k, const Axis& axis) {
  constexpr double headroom = 1.05;
  Panel panel{.x = axis, .y = {0.0, headroom, axis.title, axis.unit}};
  for (std::size_t s = plot.sets.size(); s-- > 0;) {
    const Series area{
        SeriesKind::area, density_table(s), {2 * k, 2 * k + 1}, kMethodColors[s], 0.0, 0.22};
    panel.series.push_back(area);
    panel.series.push_back({SeriesKind::line, area.table, area.columns, area.color});
    const auto samples = plot.sets[s].samples.col(k);
    if (is_constant(samples)) panel.marks.push_back({LegendMark::line, area.color, samples(0)});
  }
  for (const MarkedPoint& point : plot.points) {
    panel.marks.push_back({LegendMark::line, point.color, point.place(k), 0.0, 0.0, point.style});
  }
  return panel;
}

Panel scatter(const PairPlot& plot, Index x, Index y, const std::vector<Axis>& axes, double size) {
  Panel panel{.x = axes[static_cast<std::size_t>(x)], .y = axes[static_cast<std::size_t>(y)]};
  for (std::size_t s = plot.sets.size(); s-- > 0;) {
    panel.series.push_back(
        {SeriesKind::dots, samples_table(s), {x, y}, kMethodColors[s], 0.42 * size, 0.55});
  }
  for (const MarkedPoint& point : plot.points) {
    panel.marks.push_back({point.mark, point.color, point.place(x), point.place(y), size});
  }
  return panel;
}

// Entries of all sets, and of the points that some panel shows.
std::vector<LegendEntry> legend_of(const PairPlot& plot) {
  std::vector<LegendEntry> legend;
  for (const SampleSet& set : plot.sets) {
    legend.push_back({LegendMark::dot, kMethodColors[legend.size()], set.name});
  }
  for (const MarkedPoint& point : plot.points) {
    bool is_shown = false;
    for (Index k = 0; k < point.place.size(); ++k) {
      const PairParameter& p = plot.parameters[static_cast<std::size_t>(k)];
      is_shown = is_shown || (point.place(k) >= p.lower && point.place(k) <= p.upper);
    }
    if (is_shown) legend.push_back({point.mark, point.color, point.name});
  }
  return legend;
}

}  // namespace

Figure figure_of(const PairPlot& plot) {
  require(!plot.sets.empty() && plot.sets.size() <= kMaxMethods && plot.num_points > 0,
          "pair plot '{}': {} sample sets of {} points, must be 1 to {} of at least 1", plot.name,
          plot.sets.size(), plot.num_points, kMaxMethods);
  const PairPlot shown = select(plot);
  const auto count = static_cast<Index>(shown.parameters.size());
  std::vector<Axis> axes;
  std::string names;
  for (const PairParameter& p : shown.parameters) {
    axes.push_back(make_axis({p.lower, p.upper}, p.label, p.unit));
    names += fmt::format("{}{} [{}]", names.empty() ? "" : ", ", p.label, p.unit);
  }
  Figure figure{plot.name, axes.size(), sizes_for(axes.size()), legend_of(shown)};
  std::size_t s = 0;
  for (const auto& [name, samples] : shown.sets) {
    figure.tables.push_back(
        {samples_table(s), name + ", samples of " + names, strided_rows(samples, plot.num_points)});
    figure.tables.push_back(
        {density_table(s),
         name + ", position and marginal density, over its peak, of each of " + names,
         marginal_densities(axes, samples)});
    ++s;
  }
  const double mark = 0.35 + 0.003 * figure.sizes.panel_width;
  for (Index r = 0; r < count; ++r) {
    for (Index c = 0; c < count; ++c) {
      const Axis& axis = axes[static_cast<std::size_t>(c)];
      figure.panels.push_back(c > r    ? Panel{}
                              : c == r ? marginal(shown, c, axis)
                                       : scatter(shown, c, r, axes, mark));
    }
  }
  return figure;
}

}  // namespace npdr::analysis
