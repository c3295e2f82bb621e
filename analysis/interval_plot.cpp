#include "analysis/interval_plot.h"

#include <algorithm>

#include "analysis/figure_layout.h"

namespace npdr::analysis {
namespace {

constexpr Index kMedian = 2;              // of kIntervalLevels
constexpr double kRowShare = 0.7;         // of a parameter's row, over which its lanes are spread
constexpr double kLaneHeight = 13.0;      // [px]
constexpr double kRowPadding = 12.0;      // [px]
constexpr double kRowWidth = 640.0;       // [px]
constexpr double kLeastRowWidth = 150.0;  // [px]

double middle_of_row(Index parameter, Index count) {
  return static_cast<double>(count - parameter) - 0.5;
}

// Sets lie on lanes of their own, the first uppermost, and marked points on one below, so that they
// don't hide a narrow interval.
std::size_t num_lanes(const IntervalPlot& plot) {
  return plot.sets.size() + (plot.points.empty() ? 0 : 1);
}

double place_of_lane(const IntervalPlot& plot, Index parameter, std::size_t lane) {
  const auto count = static_cast<double>(num_lanes(plot));
  const double share = (static_cast<double>(lane) + 0.5) / count - 0.5;
  return middle_of_row(parameter, std::ssize(plot.parameters)) - kRowShare * share;
}

// Adds a level line for each row from `low` to `high`.
void add_lines(Figure& figure, Panel& panel, const Vector& low, const Vector& high, const Vector& y,
               const std::string& comment, const char* color, double size) {
  RowMatrix segments = RowMatrix::Zero(y.size(), 4);
  segments.col(0) = low;
  segments.col(1) = y;
  segments.col(2) = high - low;
  const std::string table = add_table(figure, comment, segments);
  panel.series.push_back({SeriesKind::segments, table, {0, 1, 2, 3}, color, size});
}

void add_rows(const IntervalPlot& plot, Figure& figure, Panel& panel) {
  const Index count = std::ssize(plot.parameters);
  Vector y(count);
  for (Index k = 0; k < count; ++k) {
    y(k) = middle_of_row(k, count);
    panel.y.ticks.insert(panel.y.ticks.begin(), y(k));
    std::string label = plot.parameters[static_cast<std::size_t>(k)];
    std::ranges::replace(label, '_', ' ');
    panel.y.labels.insert(panel.y.labels.begin(), label);
    panel.tips.push_back(
        {plot.row, {y(k) - 0.5, y(k) + 0.5}, plot.tips[static_cast<std::size_t>(k)]});
  }
  add_lines(figure, panel, Vector::Constant(count, plot.row.lower),
            Vector::Constant(count, plot.row.upper), y,
            "beginning of the row, place of the parameter, length of the row, 0", "#e3e7eb", 7.0);
}

void add_set(const IntervalPlot& plot, std::size_t set, Figure& figure, Panel& panel) {
  const auto& [name, quantiles] = plot.sets[set];
  const Index count = std::ssize(plot.parameters);
  require<ShapeError>(quantiles.rows() == count && quantiles.cols() == 5,
                      "interval plot '{}': quantiles of '{}' have shape ({}, {}), must be ({}, 5)",
                      plot.name, name, quantiles.rows(), quantiles.cols(), count);
  Vector y(count);
  for (Index k = 0; k < count; ++k) y(k) = place_of_lane(plot, k, set);
  const char* color = kMethodColors[set];
  for (const Index low : {Index{0}, Index{1}}) {
    add_lines(figure, panel, quantiles.col(low), quantiles.col(4 - low), y,
              name + ": beginning of the interval, place of the parameter, length, 0", color,
              low == 0 ? 1.8 : 5.0);
  }
  for (Index k = 0; k < count; ++k) {
    panel.marks.push_back({LegendMark::dot, color, quantiles(k, kMedian), y(k), 0.6});
  }
  figure.legend.push_back({LegendMark::dot, color, name});
}

void add_point(const IntervalPlot& plot, const MarkedPoint& point, Figure& figure, Panel& panel) {
  const Index count = std::ssize(plot.parameters);
  require<ShapeError>(point.place.size() == count,
                      "interval plot '{}': '{}' has {} values for {} parameters", plot.name,
                      point.name, point.place.size(), count);
  for (Index k = 0; k < count; ++k) {
    const double y = place_of_lane(plot, k, plot.sets.size());
    panel.marks.push_back({point.mark, point.color, point.place(k), y, 0.7});
  }
  figure.legend.push_back({point.mark, point.color, point.name});
}

// What is left of `width` beside the names.
double row_width(const Figure& figure, double width) {
  const FigureLayout layout(figure);
  return std::max(kLeastRowWidth, width - (layout.width - figure.sizes.panel_width));
}

}  // namespace

Figure figure_of(const IntervalPlot& plot) {
  const Index count = std::ssize(plot.parameters);
  require(count > 0 && !plot.sets.empty() && plot.sets.size() <= kMaxMethods,
          "interval plot '{}': {} parameters and {} sets, must be at least 1, and 1 to {}",
          plot.name, count, plot.sets.size(), kMaxMethods);
  require<ShapeError>(std::ssize(plot.tips) == count,
                      "interval plot '{}': {} tips for {} parameters", plot.name, plot.tips.size(),
                      count);
  Figure figure{.name = plot.name};
  figure.sizes.panel_width = kRowWidth;
  figure.sizes.panel_height = static_cast<double>(count) *
                              (kRowPadding + kLaneHeight * static_cast<double>(num_lanes(plot)));
  figure.sizes.font = figure.sizes.tick_font = 12.0;
  Panel panel{.x = make_axis(plot.row, plot.title, "", 3, 0.0),
              .y = {0.0, static_cast<double>(count)}};
  add_rows(plot, figure, panel);
  for (std::size_t set = 0; set < plot.sets.size(); ++set) add_set(plot, set, figure, panel);
  for (const MarkedPoint& point : plot.points) add_point(plot, point, figure, panel);
  figure.panels.push_back(std::move(panel));
  if (plot.width) figure.sizes.panel_width = row_width(figure, *plot.width);
  return figure;
}

}  // namespace npdr::analysis
