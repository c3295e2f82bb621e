#include "analysis/curve_plot.h"

#include <cmath>

#include "analysis/summary.h"

namespace npdr::analysis {
namespace {

constexpr double kCurveMargin = 0.03;  // of the shown values, below and above them
constexpr double kBandOpacity = 0.22;

// The curve as a table (points, 4).
RowMatrix points_of(const CurvePlot& plot, const Curve& curve) {
  const Index k = curve.x.size();
  require(k > 0, "curve plot '{}': the curve of '{}' has no points", plot.name, curve.method);
  require<ShapeError>(curve.mean.size() == k && curve.lower.size() == k && curve.upper.size() == k,
                      "curve plot '{}': {} x, {} means, {} and {} of the band", plot.name, k,
                      curve.mean.size(), curve.lower.size(), curve.upper.size());
  RowMatrix points(k, 4);
  points << curve.x, curve.mean, curve.lower, curve.upper;
  return points;
}

}  // namespace

Curve curve_of(const std::string& method, const Vector& x, const RowMatrix& experiments) {
  require<ShapeError>(experiments.rows() == x.size(), "a curve of {} points has {} x",
                      experiments.rows(), x.size());
  Curve curve{method, x, Vector(x.size()), Vector(x.size()), Vector(x.size())};
  for (Index i = 0; i < x.size(); ++i) {
    const Summary summary = summarize(experiments.row(i).transpose());
    const double spread = std::isfinite(summary.std) ? summary.std : 0.0;
    curve.mean(i) = summary.mean;
    curve.lower(i) = summary.mean - spread;
    curve.upper(i) = summary.mean + spread;
  }
  return curve;
}

Figure figure_of(const CurvePlot& plot) {
  require(!plot.curves.empty(), "curve plot '{}': must have a curve", plot.name);
  Figure figure{.name = plot.name, .sizes = {468.0, 300.0}};
  Range x, y;
  std::vector<Series> bands, curves;  // no curve is below another one's band
  for (const Curve& curve : plot.curves) {
    const RowMatrix points = points_of(plot, curve);
    const std::string table =
        add_table(figure, "x, mean, lower and upper limit of the band", points);
    const std::string color = method_color(figure, curve.method, LegendMark::band);
    x.add(curve.x);
    for (Index k = 1; k < 4; ++k) y.add(points.col(k));
    bands.push_back({SeriesKind::band, table, {0, 2, 3}, color, 0.0, kBandOpacity});
    const bool is_dot = curve.x.size() == 1;
    curves.push_back(
        {is_dot ? SeriesKind::dots : SeriesKind::line, table, {0, 1}, color, is_dot ? 0.7 : 1.8});
  }
  bands.insert(bands.end(), curves.begin(), curves.end());
  if (x.lower == x.upper) x.add(x.lower + 1.0);
  figure.panels.push_back({.x = make_axis(x.widened(kCurveMargin), plot.x_title, "", 3, 0.0),
                           .y = make_axis(y.widened(kCurveMargin), plot.y_title, "", 3, 0.0),
                           .series = bands});
  return figure;
}

}  // namespace npdr::analysis
