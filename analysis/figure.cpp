#include "analysis/figure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/figure_layout.h"
#include "analysis/figure_overlay.h"
#include "analysis/file_stem.h"

namespace npdr::analysis {
namespace {

constexpr const char* kTextColor = "#333333";
constexpr double kMarkLineWidth = 1.5;
constexpr double kLegendMarkSize = 0.8;
constexpr double kLegendBandOpacity = 0.25;

// Dark to bright, told apart by readers with any common kind of color vision (viridis).
constexpr const char* kPalette =
    "set palette defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', 4 '#7ad151', "
    "5 '#fde725')\n";

// "#rrggbb" as gnuplot's '#aarrggbb', where aa is the transparency.
std::string translucent(std::string_view color, double opacity) {
  const int transparency = static_cast<int>(std::lround(255.0 * (1.0 - opacity)));
  return fmt::format("'#{:02x}{}'", transparency, color.substr(1));
}

// Gnuplot's words for each SeriesKind; {} is the size.
constexpr const char* kSeriesStyles[] = {
    "lines lw {}", "vectors nohead lw {}",           "points pt 7 ps {}",
    "steps lw {}", "filledcurves fs solid noborder", "filledcurves y1=0 fs solid noborder",
    "image pixels"};
constexpr int kPointTypes[] = {7, 9, 13, 5};  // of each LegendMark that is a filled mark
constexpr int kDashTypes[] = {1, 2, 4};       // of each LineStyle

template <class Enum>
std::size_t number(Enum value) {
  return static_cast<std::size_t>(value);
}

// A filled mark with a white rim at `position` (gnuplot's coordinates), in front of the plot.
std::string mark_command(LegendMark mark, const std::string& position, double size,
                         std::string_view color) {
  const auto point = [&](double point_size, std::string_view point_color) {
    return fmt::format("set label '' at {} point pt {} ps {} lc rgb '{}' front\n", position,
                       kPointTypes[number(mark)], point_size, point_color);
  };
  return point(1.5 * size, "#ffffff") + point(size, color);
}

bool contains(const Axis& axis, double value) { return value >= axis.lower && value <= axis.upper; }

std::string data_file(const Figure& figure, const std::string& table) {
  return fmt::format("{}_{}.dat", figure.name, table);
}

// Writes the commands of one figure; gnuplot measures in shares of it from the bottom left.
class Script {
 public:
  Script(const Figure& figure, const FigureLayout& layout) : figure_(figure), layout_(layout) {}

  std::string commands() const {
    std::string script =
        "set multiplot\nunset key\nset border 31 lw 0.8 lc rgb '#555555'\n" + color_scale();
    for (std::size_t k = 0; k < figure_.legend.size(); ++k) {
      script += legend_entry(figure_.legend[k], layout_.legend[k]);
    }
    for (std::size_t i = 0; i < figure_.panels.size(); ++i) {
      if (figure_.panels[i].series.empty()) continue;
      script += panel(i) + "unset label\nunset arrow\nunset object\nunset colorbox\n";
    }
    return script + "unset multiplot\n";
  }

 private:
  double x_share(double x) const { return x / layout_.width; }
  double y_share(double y) const { return 1.0 - y / layout_.height; }

  std::string at(double x, double y) const {
    return fmt::format("screen {:.5f}, screen {:.5f}", x_share(x), y_share(y));
  }

  std::string text(double x, double y, std::string_view words, const char* placement,
                   double font_size) const {
    return fmt::format("set label {} at {} {} font ',{}'\n", gnuplot_string(words), at(x, y),
                       placement, font_size);
  }

  std::string tick_style() const {
    return fmt::format("scale 0.5 font ',{}' textcolor rgb '{}'", figure_.sizes.tick_font,
                       kTextColor);
  }

  std::string color_scale() const {
    if (!figure_.colors) return "";
    const Box& bar = layout_.colors;
    return kPalette +
           fmt::format(
               "set cbrange [{}:{}]\nset colorbox user origin {} size screen {:.5f}, screen "
               "{:.5f}\nset cblabel {} font ',{}'\nset cbtics {}\n",
               figure_.colors->low, figure_.colors->high, at(bar.left, bar.bottom()),
               x_share(bar.width), bar.height / layout_.height,
               gnuplot_string(figure_.colors->title), figure_.sizes.font, tick_style());
  }

  std::string legend_entry(const LegendEntry& entry, const Box& box) const {
    const double end = box.left + kLegendMarkWidth, y = box.middle();
    std::string script;
    if (entry.mark == LegendMark::band) {
      script = fmt::format(
          "set object rectangle from {} to {} fillcolor rgb {} fillstyle solid noborder\n",
          at(box.left, y + 5.0), at(end, y - 5.0), translucent(entry.color, kLegendBandOpacity));
    }
    if (entry.mark == LegendMark::band || entry.mark == LegendMark::line) {
      script += fmt::format("set arrow from {} to {} nohead lw 2 lc rgb '{}'\n", at(box.left, y),
                            at(end, y), entry.color);
    } else {
      script += mark_command(entry.mark, at(box.left + 0.5 * kLegendMarkWidth, y), kLegendMarkSize,
                             entry.color);
    }
    return script + text(end + kLegendMarkGap, y, entry.words, "left", figure_.sizes.font);
  }

  std::string panel(std::size_t i) const {
    const Panel& panel = figure_.panels[i];
    const Box& box = layout_.panels[i];
    std::string script = fmt::format(
        "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
        "set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n",
        x_share(box.left), x_share(box.right()), y_share(box.top), y_share(box.bottom()));
    script += axis('x', panel.x, is_lowest(figure_, i));
    script += axis('y', panel.y, i % figure_.columns == 0) + titles(i);
    for (const Mark& m : panel.marks) script += mark(panel, m);
    script += "plot ";
    for (const Series& s : panel.series) {
      script += (&s == panel.series.data() ? "" : ", \\\n     ") + series(panel, s);
    }
    return script + "\n";
  }

  std::string axis(char name, const Axis& axis, bool is_labeled) const {
    const std::string range = fmt::format("set {}range [{}:{}]\n", name, axis.lower * axis.scale,
                                          axis.upper * axis.scale);
    if (axis.ticks.empty()) return range + fmt::format("unset {}tics\n", name);
    std::string ticks;
    for (std::size_t i = 0; i < axis.ticks.size(); ++i) {
      const std::string label = gnuplot_string(is_labeled ? axis.labels[i] : "");
      ticks += fmt::format("{}{} {}", i > 0 ? ", " : "", label, axis.ticks[i]);
    }
    return range + fmt::format("set {}tics nomirror {} ({})\n", name, tick_style(), ticks);
  }

  // Lines of the titles that panel i shows.
  std::string titles(std::size_t i) const {
    const auto& [title, x, y, series, marks, tips] = figure_.panels[i];
    const Box& box = layout_.panels[i];
    const double font = figure_.sizes.font, tick_font = figure_.sizes.tick_font;
    const double step = kLineHeight * font;
    std::string script = text(box.center(), box.top - 0.5 * layout_.title_height,
                              elide_text(title, box.width, tick_font), "center", tick_font);
    if (is_lowest(figure_, i)) {
      double place = box.bottom() + 2.2 * tick_font + 0.9 * font;
      for (const std::string& line : title_lines(x, box.width, font)) {
        script += text(box.center(), place, line, "center", font);
        place += step;
      }
    }
    if (i % figure_.columns == 0) {
      const auto lines = title_lines(y, box.height, font);
      double place = layout_.y_titles - step * (static_cast<double>(lines.size()) - 0.5);
      for (const std::string& line : lines) {
        script += text(place, box.middle(), line, "center rotate by 90", font);
        place += step;
      }
    }
    return script;
  }

  static std::string mark(const Panel& panel, const Mark& mark) {
    const bool is_line = mark.shape == LegendMark::line;
    if (!contains(panel.x, mark.x) || !(is_line || contains(panel.y, mark.y))) return "";
    const double x = mark.x * panel.x.scale;
    if (is_line) {
      return fmt::format(
          "set arrow from first {0}, graph 0 to first {0}, graph 1 nohead front lw {1} dt {2} lc "
          "rgb '{3}'\n",
          x, kMarkLineWidth, kDashTypes[number(mark.style)], mark.color);
    }
    const std::string position = fmt::format("first {}, first {}", x, mark.y * panel.y.scale);
    return mark_command(mark.shape, position, mark.size, mark.color);
  }

  std::string series(const Panel& panel, const Series& series) const {
    std::string columns;
    for (std::size_t k = 0; k < series.columns.size(); ++k) {
      const bool is_x = k == 0 || (k == 2 && series.kind == SeriesKind::segments);
      const double scale = is_x ? panel.x.scale : panel.y.scale;
      const Index c = series.columns[k];
      columns += columns.empty() ? "" : ":";
      columns += scale == 1.0 ? std::to_string(c + 1) : fmt::format("(${}*{})", c + 1, scale);
    }
    const std::string command = fmt::format(
        "{} using {} with {}", gnuplot_string(data_file(figure_, series.table)), columns,
        fmt::format(fmt::runtime(kSeriesStyles[number(series.kind)]), series.size));
    if (series.kind == SeriesKind::cells) return command;
    return command + " lc rgb " + translucent(series.color, series.opacity);
  }

  const Figure& figure_;
  const FigureLayout& layout_;
};

}  // namespace

std::string add_table(Figure& figure, const std::string& comment, const RowMatrix& values) {
  figure.tables.push_back({std::to_string(figure.tables.size() + 1), comment, values});
  return figure.tables.back().name;
}

std::string method_color(Figure& figure, const std::string& method, LegendMark mark) {
  const auto found = std::ranges::find(figure.legend, method, &LegendEntry::words);
  if (found != figure.legend.end()) return found->color;
  const std::size_t k = figure.legend.size();
  require(k < kMaxMethods, "figure '{}': more than {} methods", figure.name, kMaxMethods);
  figure.legend.push_back({mark, kMethodColors[k], method});
  return kMethodColors[k];
}

FigureFiles write_figure(const Figure& figure, const std::filesystem::path& directory) {
  check_file_stem("figure", figure.name);
  for (const DataTable& table : figure.tables) {
    write_data_file(directory / data_file(figure, table.name), table.comment, table.values);
  }
  const FigureLayout layout(figure);
  const int width = static_cast<int>(std::lround(layout.width));
  const int height = static_cast<int>(std::lround(layout.height));
  return render_script(
      {figure.name, width, height, Script(figure, layout).commands(), overlay_of(figure, layout)},
      directory);
}

std::vector<Index> check_selection(const std::string& what, const std::vector<Index>& wanted,
                                   Index available, Index least, Index most) {
  std::vector<Index> result = wanted;
  if (result.empty()) {
    result.resize(static_cast<std::size_t>(std::min(available, most)));
    std::iota(result.begin(), result.end(), Index{0});
  }
  const auto count = static_cast<Index>(result.size());
  require(count >= least && count <= most, "{}: {} selected, must be {} to {}", what, count, least,
          most);
  for (const Index i : result) {
    require(i >= 0 && i < available, "{} {} selected, must be in [0, {}]", what, i, available - 1);
  }
  return result;
}

}  // namespace npdr::analysis
