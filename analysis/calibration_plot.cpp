#include "analysis/calibration_plot.h"

#include <algorithm>
#include <cmath>

namespace npdr::analysis {
namespace {

constexpr std::size_t kChecksPerRow = 4;
constexpr double kBand = 2.5758;  // normal deviations on either side that hold 99 %

Figure empty_figure(const std::string& name, std::size_t num_panels) {
  require(num_panels > 0, "calibration plot '{}': must have something to draw", name);
  return {.name = name, .columns = std::min(num_panels, kChecksPerRow)};
}

// A panel that shows what a posterior without fault gives, from table "expected".
Panel panel_of(const std::string& title, const char* x, const char* y, double y_upper) {
  return {title,
          make_axis({0.0, 1.0}, x, "", 3, 0.0),
          make_axis({0.0, y_upper}, y, "", 3, 0.0),
          {{SeriesKind::band, "expected", {0, 1, 2}, "#dddddd"},
           {SeriesKind::line, "expected", {0, 3}, "#888888", 0.8}}};
}

DataTable expected_table(const Vector& x, const Vector& middle, const Vector& half_width) {
  RowMatrix values(x.size(), 4);
  values << x, middle - half_width, middle + half_width, middle;
  return {"expected", "x, lower and upper limit of 99 %, expected value", values};
}

// Borders of the bins and, for each parameter, the share over the even one, once for each border: a
// staircase that ends where the last bin does.
RowMatrix staircase(const RowMatrix& counts) {
  const Index bins = counts.rows();
  RowMatrix stairs(bins + 1, 1 + counts.cols());
  stairs.col(0) = Vector::LinSpaced(bins + 1, 0.0, 1.0);
  const Eigen::RowVectorXd even = counts.colwise().sum() / static_cast<double>(bins);
  stairs.block(0, 1, bins, counts.cols()) = counts.array().rowwise() / even.array();
  stairs.row(bins).tail(counts.cols()) = stairs.row(bins - 1).tail(counts.cols());
  return stairs;
}

// Half the width of the band around 1.
double band_of(const RowMatrix& counts) {
  const auto bins = static_cast<double>(counts.rows());
  return kBand * std::sqrt((bins - 1.0) / counts.col(0).sum());
}

}  // namespace

Figure figure_of(const RankPlot& plot) {
  const auto num_parameters = static_cast<Index>(plot.parameters.size());
  Figure figure = empty_figure(plot.name, plot.methods.empty() ? 0 : plot.parameters.size());
  std::vector<Series> steps;  // of the first parameter
  double band = 0.0, highest = 0.0;
  for (const auto& [method, counts] : plot.methods) {
    require<ShapeError>(counts.cols() == num_parameters,
                        "calibration plot '{}': counts of {} parameters, must be {}", plot.name,
                        counts.cols(), num_parameters);
    require(counts.size() > 0 && counts.colwise().sum().minCoeff() > 0.0,
            "calibration plot '{}': must have ranks", plot.name);
    if (steps.empty()) band = band_of(counts);
    const RowMatrix stairs = staircase(counts);
    highest = std::max({highest, stairs.rightCols(num_parameters).maxCoeff(), 1.0 + band});
    const std::string table = add_table(
        figure, "left border of the bin, then for each parameter: share of ranks over the even one",
        stairs);
    steps.push_back(
        {SeriesKind::steps, table, {0, 1}, method_color(figure, method, LegendMark::line)});
  }
  figure.tables.push_back(
      expected_table(Vector::LinSpaced(2, 0.0, 1.0), Vector::Ones(2), Vector::Constant(2, band)));
  for (const std::string& parameter : plot.parameters) {
    Panel panel = panel_of(parameter, "rank / samples", "share", 1.1 * highest);
    panel.series.insert(panel.series.end(), steps.begin(), steps.end());
    figure.panels.push_back(std::move(panel));
    for (Series& series : steps) ++series.columns.back();
  }
  return figure;
}

Figure figure_of(const CoveragePlot& plot) {
  Figure figure = empty_figure(plot.name, plot.panels.size());
  for (const CoveragePanel& shown : plot.panels) {
    Panel panel = panel_of(shown.title, "level", "coverage", 1.0);
    for (const auto& [method, level, coverage] : shown.curves) {
      require<ShapeError>(level.size() == coverage.size(),
                          "calibration plot '{}': {} levels, {} coverages", plot.name, level.size(),
                          coverage.size());
      RowMatrix points(level.size(), 2);
      points << level, coverage;
      const std::string color = method_color(figure, method, LegendMark::line);
      panel.series.push_back(
          {SeriesKind::line, add_table(figure, "level, coverage", points), {0, 1}, color});
    }
    figure.panels.push_back(std::move(panel));
  }
  const Vector level = Vector::LinSpaced(101, 0.0, 1.0);
  const double width =
      plot.num_truths > 0 ? kBand / std::sqrt(static_cast<double>(plot.num_truths)) : 0.0;
  figure.tables.push_back(
      expected_table(level, level, width * (level.array() * (1.0 - level.array())).sqrt()));
  return figure;
}

}  // namespace npdr::analysis
