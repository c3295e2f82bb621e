#include "analysis/pair_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/file_stem.h"
#include "analysis/kernel_density.h"
#include "analysis/pair_plot_script.h"
#include "analysis/plot_layout.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

std::vector<Index> check_selection(const PairPlot& plot) {
  const auto available = static_cast<Index>(plot.parameters.size());
  std::vector<Index> shown = plot.selection;
  if (shown.empty()) {
    shown.resize(plot.parameters.size());
    std::iota(shown.begin(), shown.end(), Index{0});
  }
  const auto count = static_cast<Index>(shown.size());
  if (count < kMinPairParameters || count > kMaxPairParameters) {
    throw InputError(fmt::format("pair plot '{}': {} parameters, must be {} to {}; select some",
                                 plot.name, count, kMinPairParameters, kMaxPairParameters));
  }
  for (const Index d : shown) {
    if (d >= 0 && d < available) continue;
    throw InputError(fmt::format("pair plot '{}': parameter {} selected, must be in [0, {}]",
                                 plot.name, d, available - 1));
  }
  return shown;
}

void check(const PairPlot& plot) {
  check_file_stem("pair plot", plot.name);
  if (plot.sets.empty() || plot.sets.size() > kMaxMethods || plot.num_points < 1) {
    throw InputError(
        fmt::format("pair plot '{}': {} sample sets of {} points, must be 1 to {} of "
                    "at least 1",
                    plot.name, plot.sets.size(), plot.num_points, kMaxMethods));
  }
  for (const SampleSet& set : plot.sets) {
    if (set.samples.cols() == static_cast<Index>(plot.parameters.size())) continue;
    throw ShapeError(
        fmt::format("pair plot '{}': samples of '{}' have {} columns for {} parameters", plot.name,
                    set.name, set.samples.cols(), plot.parameters.size()));
  }
  for (const PairPoint& point : plot.points) {
    if (point.theta.size() == static_cast<Index>(plot.parameters.size())) continue;
    throw ShapeError(fmt::format("pair plot '{}': '{}' has {} values for {} parameters", plot.name,
                                 point.name, point.theta.size(), plot.parameters.size()));
  }
}

// Evenly strided rows in the shown columns: chains of an MCMC sampler are all represented.
RowMatrix shown_samples(const RowMatrix& samples, const std::vector<Index>& shown, Index count) {
  const Index rows = std::min(count, samples.rows());
  RowMatrix result(rows, static_cast<Index>(shown.size()));
  for (Index i = 0; i < rows; ++i) {
    for (std::size_t k = 0; k < shown.size(); ++k) {
      result(i, static_cast<Index>(k)) = samples(i * samples.rows() / rows, shown[k]);
    }
  }
  return result;
}

// Columns 2 k and 2 k + 1: position and density of shown parameter k.
RowMatrix marginal_densities(const PairPlot& plot, const RowMatrix& samples,
                             const std::vector<Index>& shown) {
  RowMatrix curves;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const PairParameter& p = plot.parameters[static_cast<std::size_t>(shown[k])];
    RowMatrix curve = kernel_density(samples.col(shown[k]), p.lower, p.upper);
    if (is_constant(samples.col(shown[k]))) curve.col(1).setZero();
    curves.conservativeResize(curve.rows(), 2 * static_cast<Index>(k) + 2);
    curves.rightCols(2) = curve;
  }
  return curves;
}

// Where the axis of shown parameter k ends: at the highest peak, but for spikes that would flatten
// the curves of the other sets. Curves with little of their samples inside the box don't count.
double top_of(const std::vector<RowMatrix>& curves, Index k) {
  constexpr double tallest_ratio = 8.0, headroom = 1.05;
  double highest = 0.0, lowest = std::numeric_limits<double>::infinity();
  for (const RowMatrix& curve : curves) {
    const double peak = curve.col(2 * k + 1).maxCoeff();
    const double share = curve.col(2 * k + 1).sum() * (curve(1, 2 * k) - curve(0, 2 * k));
    highest = std::max(highest, peak);
    if (share > 0.5) lowest = std::min(lowest, peak);
  }
  return highest > 0.0 ? headroom * std::min(highest, tallest_ratio * lowest) : 1.0;
}

}  // namespace

FigureFiles write_pair_plot(const PairPlot& plot, const std::filesystem::path& directory) {
  check(plot);
  const std::vector<Index> shown = check_selection(plot);
  std::vector<RowMatrix> curves;
  for (const SampleSet& set : plot.sets) {
    curves.push_back(marginal_densities(plot, set.samples, shown));
  }
  std::vector<double> tops;
  for (Index k = 0; k < static_cast<Index>(shown.size()); ++k) tops.push_back(top_of(curves, k));
  const PairPlotScript script(plot, shown, tops);
  std::string columns;
  for (const Index d : shown) {
    const PairParameter& p = plot.parameters[static_cast<std::size_t>(d)];
    columns += fmt::format("{}{} [{}]", columns.empty() ? "" : ", ", p.label, p.unit);
  }
  for (std::size_t k = 0; k < plot.sets.size(); ++k) {
    const SampleSet& set = plot.sets[k];
    write_data_file(directory / script.samples_file(k), set.name + ", samples of " + columns,
                    shown_samples(set.samples, shown, plot.num_points));
    write_data_file(directory / script.density_file(k),
                    set.name + ", position and marginal density of each of " + columns, curves[k]);
  }
  return render_figure({plot.name, static_cast<int>(std::lround(script.width())),
                        static_cast<int>(std::lround(script.height())), script.commands()},
                       directory);
}

}  // namespace npdr::analysis
