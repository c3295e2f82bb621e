#include "analysis/heat_map.h"

#include <algorithm>
#include <cmath>

#include "analysis/figure_layout.h"
#include "analysis/number_text.h"
#include "core/constants.h"

namespace npdr::analysis {
namespace {

constexpr double kPanel = 210.0;  // [px]
constexpr std::size_t kMapsPerRow = 3;
constexpr const char* kMarkColor = "#d7191c";

// The axis of cells 0, 1, ..., with as many labels as there is room for when each takes `room` px.
Axis cell_axis(const GridAxis& grid, double room) {
  const Index count = grid.points.size();
  Axis axis{.lower = -0.5, .upper = static_cast<double>(count) - 0.5, .title = grid.title};
  if (!grid.unit.empty() && grid.unit != "1") axis.unit = "[" + grid.unit + "]";
  const auto every = static_cast<Index>(std::ceil(static_cast<double>(count) * room / kPanel));
  for (Index i = 0; i < count; i += every) {
    axis.ticks.push_back(static_cast<double>(i));
    axis.labels.push_back(number_text(grid.points(i), NumberStyle::plain));
  }
  return axis;
}

// Position of a value among the cells; NaN outside of the points.
double position(const Vector& points, double value) {
  const Index last = points.size() - 1;
  if (value < points(0) || value > points(last)) return kNaN;
  Index i = 0;
  while (i < last && points(i + 1) < value) ++i;
  if (i == last) return static_cast<double>(i);
  return static_cast<double>(i) + (value - points(i)) / (points(i + 1) - points(i));
}

// A line per cell: its position, and its value.
RowMatrix cells_of(const RowMatrix& values) {
  RowMatrix cells(values.size(), 3);
  Index row = 0;
  for (Index i = 0; i < values.rows(); ++i) {
    for (Index j = 0; j < values.cols(); ++j) {
      cells.row(row++) << static_cast<double>(i), static_cast<double>(j), values(i, j);
    }
  }
  return cells;
}

}  // namespace

Figure figure_of(const HeatMapPlot& plot) {
  const Index num_x = plot.x.points.size(), num_y = plot.y.points.size();
  require(
      !plot.maps.empty() && num_x > 0 && num_y > 0 && plot.low < plot.high,
      "heat map '{}': must have a map, points on both axes, and colors from low to a larger high",
      plot.name);
  Figure figure{plot.name, std::min(plot.maps.size(), kMapsPerRow), {kPanel, kPanel}};
  figure.colors = {plot.value_title, plot.low, plot.high};
  double widest = 0.0;
  for (const double point : plot.x.points) {
    const std::string label = number_text(point, NumberStyle::plain) + " ";
    widest = std::max(widest, text_width(label, figure.sizes.tick_font));
  }
  figure.sizes.gap = std::max(figure.sizes.gap, widest);  // the last labels stick out
  Panel panel{"", cell_axis(plot.x, widest), cell_axis(plot.y, 2.0 * figure.sizes.tick_font)};
  if (plot.mark) {
    panel.marks = {{LegendMark::diamond, kMarkColor, position(plot.x.points, plot.mark->first),
                    position(plot.y.points, plot.mark->second), 1.1}};
  }
  for (const auto& [title, values] : plot.maps) {
    require<ShapeError>(values.rows() == num_x && values.cols() == num_y,
                        "heat map '{}': values of shape ({}, {}), must be ({}, {})", plot.name,
                        values.rows(), values.cols(), num_x, num_y);
    panel.title = title;
    panel.series = {{SeriesKind::cells,
                     add_table(figure, "cell along x, cell along y, value", cells_of(values)),
                     {0, 1, 2}}};
    figure.panels.push_back(panel);
  }
  return figure;
}

}  // namespace npdr::analysis
