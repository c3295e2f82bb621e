#include "analysis/heat_map.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/file_stem.h"
#include "analysis/number_text.h"
#include "analysis/plot_layout.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// Sizes in pixels.
constexpr double kPanel = 210.0;
constexpr double kLeft = 84.0;
constexpr double kGap = 22.0;
constexpr double kTitle = 26.0;
constexpr double kBottom = 62.0;
constexpr double kRight = 96.0;  // colours and their title
constexpr double kBar = 14.0;
constexpr double kFont = 11.0;
constexpr Index kPanelsPerRow = 3;
constexpr Index kMaxLabels = 6;

// Dark to bright, told apart by readers with any common kind of colour vision (viridis).
constexpr const char* kPalette =
    "set palette defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', 4 '#7ad151', "
    "5 '#fde725')\n";
constexpr const char* kMarkColor = "#d7191c";

void check(const HeatMapPlot& plot) {
  check_file_stem("heat map", plot.name);
  const auto require = [&](bool good, const char* words) {
    if (!good) throw InputError(fmt::format("heat map '{}': {}", plot.name, words));
  };
  require(!plot.maps.empty(), "must have a map");
  require(plot.x.points.size() > 0 && plot.y.points.size() > 0, "must have points on both axes");
  require(plot.low < plot.high, "must have colours from low to a larger high");
  for (const HeatMap& map : plot.maps) {
    if (map.values.rows() == plot.x.points.size() && map.values.cols() == plot.y.points.size()) {
      continue;
    }
    throw ShapeError(fmt::format("heat map '{}': values of shape ({}, {}), must be ({}, {})",
                                 plot.name, map.values.rows(), map.values.cols(),
                                 plot.x.points.size(), plot.y.points.size()));
  }
}

Index num_columns(const HeatMapPlot& plot) {
  return std::min(static_cast<Index>(plot.maps.size()), kPanelsPerRow);
}

Index num_rows(const HeatMapPlot& plot) {
  return (static_cast<Index>(plot.maps.size()) + kPanelsPerRow - 1) / kPanelsPerRow;
}

double width_of(const HeatMapPlot& plot) {
  return kLeft + static_cast<double>(num_columns(plot)) * (kPanel + kGap) - kGap + kRight;
}

double height_of(const HeatMapPlot& plot) {
  return static_cast<double>(num_rows(plot)) * (kTitle + kPanel + kBottom);
}

Panel area_of(Index map) {
  return {kLeft + static_cast<double>(map % kPanelsPerRow) * (kPanel + kGap),
          kTitle + static_cast<double>(map / kPanelsPerRow) * (kTitle + kPanel + kBottom), kPanel,
          kPanel};
}

// The axis of cells 0, 1, ...; not all of them are labelled where there are many.
std::string axis_command(const GridAxis& axis, const std::string& name, bool labelled) {
  const Index count = axis.points.size();
  const Index every = (count + kMaxLabels - 1) / kMaxLabels;
  std::vector<std::string> labels;
  for (Index i = 0; i < count; i += every) {
    const std::string text = labelled ? number_text(axis.points(i), NumberStyle::plain) : "";
    labels.push_back(fmt::format("{} {}", gnuplot_string(text), i));
  }
  return fmt::format("set {0}range [-0.5:{1}]\nset {0}tics ({2}) scale 0.4{3}\n", name,
                     static_cast<double>(count) - 0.5, fmt::join(labels, ", "),
                     name == "x" ? " rotate by -35" : "");
}

std::string title_of(const GridAxis& axis) {
  std::string title = axis.title;
  std::ranges::replace(title, '_', ' ');
  const bool has_unit = !axis.unit.empty() && axis.unit != "1";
  return has_unit ? fmt::format("{} [{}]", title, axis.unit) : title;
}

// Where a value lies among the cells; nothing outside of the points.
std::optional<double> position(const Vector& points, double value) {
  if (value < points(0) || value > points(points.size() - 1)) return std::nullopt;
  Index i = 0;
  while (i + 1 < points.size() && points(i + 1) < value) ++i;
  if (i + 1 == points.size()) return static_cast<double>(i);
  return static_cast<double>(i) + (value - points(i)) / (points(i + 1) - points(i));
}

std::string mark_of(const HeatMapPlot& plot) {
  if (!plot.mark) return "";
  const auto x = position(plot.x.points, plot.mark->first);
  const auto y = position(plot.y.points, plot.mark->second);
  if (!x || !y) return "";
  return mark_command(LegendMark::diamond, fmt::format("first {}, first {}", *x, *y), 1.1,
                      kMarkColor);
}

std::string file_of(const HeatMapPlot& plot, Index map) {
  return fmt::format("{}_{}.dat", plot.name, map + 1);
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

std::string map_commands(const HeatMapPlot& plot, const PlotLayout& layout, Index map) {
  const Panel area = area_of(map);
  const double middle = area.left + 0.5 * kPanel;
  const bool is_first = map % kPanelsPerRow == 0;
  const std::string title = plot.maps[static_cast<std::size_t>(map)].title;
  std::string script = layout.margins(area);
  script +=
      layout.text(middle, area.top - 0.45 * kTitle, elide_text(title, kPanel, kFont), "center");
  script += layout.text(middle, area.top + kPanel + 0.78 * kBottom, title_of(plot.x), "center");
  if (is_first) {
    script +=
        layout.text(0.16 * kLeft, area.top + 0.5 * kPanel, title_of(plot.y), "center rotate by 90");
  }
  script += axis_command(plot.x, "x", true) + axis_command(plot.y, "y", is_first);
  script += mark_of(plot);
  script += fmt::format("plot {} using 1:2:3 with image pixels\nunset label\nunset colorbox\n",
                        gnuplot_string(file_of(plot, map)));
  return script;
}

// Beside the first row of maps; drawn along with the first of them.
std::string color_bar(const HeatMapPlot& plot) {
  const double width = width_of(plot), height = height_of(plot);
  const double left = width - kRight + 12.0;
  return fmt::format(
      "set cbrange [{}:{}]\nset colorbox user origin screen {}, screen {} size screen {}, screen "
      "{}\nset cblabel {}\nset cbtics scale 0.4\n",
      plot.low, plot.high, left / width, 1.0 - (kTitle + kPanel) / height, kBar / width,
      kPanel / height, gnuplot_string(plot.value_title));
}

}  // namespace

FigureFiles write_heat_maps(const HeatMapPlot& plot, const std::filesystem::path& directory) {
  check(plot);
  const PlotLayout layout(width_of(plot), height_of(plot));
  std::string script = "set multiplot\nunset key\nset border 31 lw 0.8 lc rgb '#555555'\n";
  script += kPalette + color_bar(plot);
  for (Index map = 0; map < static_cast<Index>(plot.maps.size()); ++map) {
    write_data_file(directory / file_of(plot, map), "cell along x, cell along y, value",
                    cells_of(plot.maps[static_cast<std::size_t>(map)].values));
    script += map_commands(plot, layout, map);
  }
  Figure figure;
  figure.name = plot.name;
  figure.width = static_cast<int>(width_of(plot));
  figure.height = static_cast<int>(height_of(plot));
  figure.commands = script + "unset multiplot\n";
  return render_figure(figure, directory);
}

}  // namespace npdr::analysis
