#include "analysis/path_plot.h"

#include "core/constants.h"

namespace npdr::analysis {
namespace {

constexpr double kPanelWidth = 420.0;  // [px]
constexpr const char* kFixedColor = "#333333";
constexpr const char* kHeldOutColor = "#888888";
constexpr const char* kPathColor = kMethodColors[0];
constexpr const char* kShapeColor = kMethodColors[1];
constexpr double kPathMargin = 0.05;  // of the shown range, on every side

enum class LineKind { path, polygon };

// All lines, a row of NaN after each; polygons end where they begin.
DataTable table_of(const PathPlot& plot, const std::string& name,
                   const std::vector<RowMatrix>& lines, LineKind kind) {
  const bool are_closed = kind == LineKind::polygon;
  Index count = 0;
  for (const RowMatrix& line : lines) {
    require<ShapeError>(line.cols() == 2 && line.rows() > 0,
                        "path plot '{}': {} points of {} coordinates, must be at least 1 of 2",
                        plot.name, line.rows(), line.cols());
    count += line.rows() + (are_closed ? 2 : 1);
  }
  RowMatrix points = RowMatrix::Constant(count, 2, kNaN);
  Index row = 0;
  for (const RowMatrix& line : lines) {
    points.middleRows(row, line.rows()) = line;
    row += line.rows();
    if (are_closed) points.row(row++) = line.row(0);
    ++row;
  }
  return {name, "x, y", points};
}

std::vector<LegendEntry> legend_of(const PathPlot& plot) {
  const bool all_seen = plot.held_out.empty();
  std::vector<LegendEntry> legend = {
      {LegendMark::line, kTruthColor, all_seen ? "target domain" : "target domain, seen"}};
  if (!all_seen) legend.push_back({LegendMark::line, kHeldOutColor, "held out"});
  legend.push_back({LegendMark::line, kPathColor, "predicted paths"});
  legend.push_back({LegendMark::line, kShapeColor, "shapes"});
  return legend;
}

}  // namespace

Figure figure_of(const PathPlot& plot) {
  const std::size_t count = plot.predictions.size();
  require(count > 0 && count <= kMaxMethods && !plot.fixed.empty(),
          "path plot '{}': {} methods and {} fixed polygons, must be 1 to {} and at least 1",
          plot.name, count, plot.fixed.size(), kMaxMethods);
  Figure figure{.name = plot.name,
                .columns = count,
                .sizes = {.panel_width = kPanelWidth},
                .legend = legend_of(plot),
                .tables = {table_of(plot, "fixed", plot.fixed, LineKind::polygon),
                           table_of(plot, "recorded", plot.recorded, LineKind::path),
                           table_of(plot, "held_out", plot.held_out, LineKind::path)}};
  Range x, y;
  x.add(figure.tables.front().values.col(0));
  y.add(figure.tables.front().values.col(1));
  const Axis x_axis = make_axis(x.widened(kPathMargin), "x", plot.unit, 4, 0.0);
  const Axis y_axis = make_axis(y.widened(kPathMargin), "y", plot.unit, 4, 0.0);
  figure.sizes.panel_height = kPanelWidth * y.length() / x.length();
  const auto line = [](const std::string& table, const char* color, double size,
                       double opacity = 1.0) {
    return Series{SeriesKind::line, table, {0, 1}, color, size, opacity};
  };
  for (const PathPrediction& prediction : plot.predictions) {
    const std::string number = std::to_string(figure.panels.size() + 1);
    const std::string outlines = "outlines_" + number, paths = "paths_" + number;
    figure.tables.push_back(table_of(plot, outlines, prediction.outlines, LineKind::polygon));
    figure.tables.push_back(table_of(plot, paths, prediction.paths, LineKind::path));
    figure.panels.push_back(
        {prediction.name,
         x_axis,
         y_axis,
         {line(outlines, kShapeColor, 0.8, 0.4), line(paths, kPathColor, 0.8, 0.35),
          line("fixed", kFixedColor, 1.5), line("held_out", kHeldOutColor, 1.0),
          line("recorded", kTruthColor, 1.8)}});
  }
  return figure;
}

}  // namespace npdr::analysis
