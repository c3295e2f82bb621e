#include "analysis/path_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "analysis/file_stem.h"
#include "analysis/plot_layout.h"
#include "core/atomic_file.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// Sizes in pixels.
constexpr double kPanelWidth = 420.0;
constexpr double kLeft = 64.0;
constexpr double kRight = 16.0;
constexpr double kGap = 24.0;
constexpr double kTop = 8.0;
constexpr double kLegendLine = 19.0;
constexpr double kTitleHeight = 24.0;
constexpr double kBottom = 44.0;
constexpr double kFont = 11.0;
constexpr const char* kHeldOutColor = "#888888";
constexpr const char* kPathColor = kMethodColors[0];
constexpr const char* kShapeColor = kMethodColors[1];
constexpr double kMargin = 0.05;  // of the shown range, on every side

using Lines = std::vector<RowMatrix>;

void check(const PathPlot& plot) {
  check_file_stem("path plot", plot.name);
  if (plot.predictions.empty() || plot.predictions.size() > kMaxMethods || plot.fixed.empty()) {
    throw InputError(fmt::format(
        "path plot '{}': {} methods and {} fixed polygons, must be 1 to {} and at least 1",
        plot.name, plot.predictions.size(), plot.fixed.size(), kMaxMethods));
  }
  const auto check_lines = [&](const Lines& lines) {
    for (const RowMatrix& line : lines) {
      if (line.cols() == 2 && line.rows() > 0) continue;
      throw ShapeError(
          fmt::format("path plot '{}': {} points of {} coordinates, must be at least 1 "
                      "of 2",
                      plot.name, line.rows(), line.cols()));
    }
  };
  for (const Lines* lines : {&plot.fixed, &plot.recorded, &plot.held_out}) check_lines(*lines);
  for (const PathPrediction& prediction : plot.predictions) {
    check_lines(prediction.paths);
    check_lines(prediction.outlines);
  }
}

// Lines for gnuplot, an empty line between them; polygons end where they begin.
void write_lines(const std::filesystem::path& path, const Lines& lines, bool are_closed) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  for (const RowMatrix& line : lines) {
    const Index count = line.rows() + (are_closed ? 1 : 0);
    for (Index i = 0; i < count; ++i) {
      const Index k = i % line.rows();
      fmt::format_to(out, "{} {}\n", line(k, 0), line(k, 1));
    }
    text.push_back('\n');
  }
  write_text_file(path, {text.data(), text.size()});
}

struct Range {
  double low, high;
  double size() const { return high - low; }
};

Range range_of(const Lines& lines, Index column) {
  Range range{lines.front()(0, column), lines.front()(0, column)};
  for (const RowMatrix& line : lines) {
    range.low = std::min(range.low, line.col(column).minCoeff());
    range.high = std::max(range.high, line.col(column).maxCoeff());
  }
  const double margin = kMargin * range.size();
  return {range.low - margin, range.high + margin};
}

class Script {
 public:
  explicit Script(const PathPlot& plot)
      : plot_(plot), x_(range_of(plot.fixed, 0)), y_(range_of(plot.fixed, 1)) {}

  double width() const {
    const auto count = static_cast<double>(plot_.predictions.size());
    return kLeft + count * (kPanelWidth + kGap) - kGap + kRight;
  }
  double panel_height() const { return kPanelWidth * y_.size() / x_.size(); }
  double top() const { return kTop + kLegendLine + kTitleHeight; }
  double height() const { return top() + panel_height() + kBottom; }

  std::string file(const std::string& what) const {
    return fmt::format("{}_{}.dat", plot_.name, what);
  }

  std::string commands() const {
    std::string script =
        "set multiplot\nunset key\nset border 31 lw 0.8 lc rgb '#555555'\nset tics scale 0.5\n";
    script += legend();
    script +=
        fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x_.low, x_.high, y_.low, y_.high);
    for (std::size_t k = 0; k < plot_.predictions.size(); ++k) {
      script += panel(k) + "unset label\nunset object\n";
    }
    return script + "unset multiplot\n";
  }

 private:
  std::string legend() const {
    const PlotLayout layout(width(), height());
    const bool all_seen = plot_.held_out.empty();
    std::vector<LegendEntry> entries = {
        {LegendMark::line, kTruthColor, all_seen ? "target domain" : "target domain, seen"}};
    if (!all_seen) entries.push_back({LegendMark::line, kHeldOutColor, "held out"});
    entries.push_back({LegendMark::line, kPathColor, "predicted paths"});
    entries.push_back({LegendMark::line, kShapeColor, "shapes"});
    std::string commands;
    double x = kLeft;
    for (const LegendEntry& entry : entries) {
      commands += legend_commands(layout, entry, x, kTop + 0.5 * kLegendLine, kFont);
      x += legend_entry_width(entry, kFont) + 2.0 * kFont;
    }
    return commands;
  }

  std::string panel(std::size_t k) const {
    const PlotLayout layout(width(), height());
    const Panel area{kLeft + static_cast<double>(k) * (kPanelWidth + kGap), top(), kPanelWidth,
                     panel_height()};
    std::string script = layout.margins(area);
    script += layout.text(area.left + 0.5 * area.width, area.top - 0.5 * kTitleHeight,
                          plot_.predictions[k].name, "center");
    script += layout.text(area.left + 0.5 * area.width, area.top + area.height + 0.75 * kBottom,
                          fmt::format("x [{}]", plot_.unit), "center");
    if (k == 0) {
      script += layout.text(0.25 * kLeft, area.top + 0.5 * area.height,
                            fmt::format("y [{}]", plot_.unit), "center rotate by 90");
    }
    const auto line = [&](const std::string& what, const std::string& style) {
      return fmt::format("{} using 1:2 with lines {}", gnuplot_string(file(what)), style);
    };
    script += "plot " + line(fmt::format("outlines_{}", k + 1),
                             fmt::format("lw 0.8 lc rgb {}", translucent(kShapeColor, 0.4)));
    script += ", " + line(fmt::format("paths_{}", k + 1),
                          fmt::format("lw 0.8 lc rgb {}", translucent(kPathColor, 0.35)));
    script += ", " + line("fixed", "lw 1.5 lc rgb '#333333'");
    const std::string held_out_style = fmt::format("lw 1 lc rgb {}", gnuplot_string(kHeldOutColor));
    const std::string recorded_style = fmt::format("lw 1.8 lc rgb {}", gnuplot_string(kTruthColor));
    if (!plot_.held_out.empty()) script += ", " + line("held_out", held_out_style);
    if (!plot_.recorded.empty()) script += ", " + line("recorded", recorded_style);
    return script + "\n";
  }

  const PathPlot& plot_;
  Range x_, y_;
};

}  // namespace

FigureFiles write_path_plot(const PathPlot& plot, const std::filesystem::path& directory) {
  check(plot);
  const Script script(plot);
  write_lines(directory / script.file("fixed"), plot.fixed, true);
  write_lines(directory / script.file("recorded"), plot.recorded, false);
  write_lines(directory / script.file("held_out"), plot.held_out, false);
  for (std::size_t k = 0; k < plot.predictions.size(); ++k) {
    const PathPrediction& prediction = plot.predictions[k];
    write_lines(directory / script.file(fmt::format("outlines_{}", k + 1)), prediction.outlines,
                true);
    write_lines(directory / script.file(fmt::format("paths_{}", k + 1)), prediction.paths, false);
  }
  return render_figure({plot.name, static_cast<int>(std::lround(script.width())),
                        static_cast<int>(std::lround(script.height())), script.commands()},
                       directory);
}

}  // namespace npdr::analysis
