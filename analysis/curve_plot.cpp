#include "analysis/curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/file_stem.h"
#include "analysis/plot_layout.h"
#include "analysis/summary.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// Sizes in pixels.
constexpr double kWidth = 560.0;
constexpr double kPanelHeight = 300.0;
constexpr double kLeft = 74.0;
constexpr double kRight = 18.0;
constexpr double kTop = 10.0;
constexpr double kLegendLine = 19.0;
constexpr double kBottom = 52.0;
constexpr double kFont = 12.0;
constexpr double kBandOpacity = 0.22;

void check(const CurvePlot& plot) {
  check_file_stem("curve plot", plot.name);
  if (plot.curves.empty() || plot.curves.size() > kMaxMethods) {
    throw InputError(fmt::format("curve plot '{}': {} curves, must be 1 to {}", plot.name,
                                 plot.curves.size(), kMaxMethods));
  }
  for (const Curve& curve : plot.curves) {
    const Index k = curve.x.size();
    if (k == 0) {
      throw InputError(
          fmt::format("curve plot '{}': the curve of '{}' has no points", plot.name, curve.method));
    }
    if (curve.mean.size() == k && curve.lower.size() == k && curve.upper.size() == k) continue;
    throw ShapeError(fmt::format("curve plot '{}': {} x, {} means, {} and {} of the band",
                                 plot.name, k, curve.mean.size(), curve.lower.size(),
                                 curve.upper.size()));
  }
}

LegendEntry entry_of(const CurvePlot& plot, std::size_t k) {
  return {LegendMark::band, kMethodColors[k], plot.curves[k].method};
}

// One below the other: names of methods are long.
std::string legend(const CurvePlot& plot, const PlotLayout& layout) {
  std::string script;
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    const double y = kTop + (static_cast<double>(k) + 0.5) * kLegendLine;
    script += legend_commands(layout, entry_of(plot, k), kLeft, y, kFont);
  }
  return script;
}

std::string file_of(const CurvePlot& plot, std::size_t k) {
  return fmt::format("{}_{}.dat", plot.name, k + 1);
}

void write_data(const CurvePlot& plot, const std::filesystem::path& directory) {
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    const Curve& curve = plot.curves[k];
    RowMatrix points(curve.x.size(), 4);
    points << curve.x, curve.mean, curve.lower, curve.upper;
    write_data_file(directory / file_of(plot, k), "x, mean, lower and upper limit of the band",
                    points);
  }
}

// Bands first, so that no curve is below another one's.
std::string plot_command(const CurvePlot& plot) {
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    parts.push_back(fmt::format("{} using 1:3:4 with filledcurves fs solid noborder lc rgb {}",
                                gnuplot_string(file_of(plot, k)),
                                translucent(kMethodColors[k], kBandOpacity)));
  }
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    const bool is_dot = plot.curves[k].x.size() == 1;
    parts.push_back(fmt::format("{} using 1:2 {} lc rgb '{}'", gnuplot_string(file_of(plot, k)),
                                is_dot ? "with points pt 7 ps 0.7" : "with lines lw 1.8",
                                kMethodColors[k]));
  }
  return fmt::format("plot {}\n", fmt::join(parts, ", \\\n     "));
}

double last_x(const CurvePlot& plot) {
  double last = plot.curves.front().x.maxCoeff();
  for (const Curve& curve : plot.curves) last = std::max(last, curve.x.maxCoeff());
  return last;
}

}  // namespace

Curve curve_of(const std::string& method, const Vector& x, const RowMatrix& experiments) {
  if (experiments.rows() != x.size()) {
    throw ShapeError(fmt::format("a curve of {} points has {} x", experiments.rows(), x.size()));
  }
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

FigureFiles write_curve_plot(const CurvePlot& plot, const std::filesystem::path& directory) {
  check(plot);
  write_data(plot, directory);
  const double legend_height = kLegendLine * static_cast<double>(plot.curves.size());
  const double height = kTop + legend_height + kTop + kPanelHeight + kBottom;
  const PlotLayout layout(kWidth, height);
  const Panel area{kLeft, kTop + legend_height + kTop, kWidth - kLeft - kRight, kPanelHeight};
  std::string script =
      "unset key\nset border 3 lw 0.8 lc rgb '#555555'\nset tics nomirror scale 0.5\n";
  script += legend(plot, layout) + layout.margins(area);
  script += fmt::format("set xrange [0:{}]\nset xlabel {}\nset ylabel {}\n",
                        std::max(1.0, 1.02 * last_x(plot)), gnuplot_string(plot.x_title),
                        gnuplot_string(plot.y_title));
  Figure figure;
  figure.name = plot.name;
  figure.width = static_cast<int>(kWidth);
  figure.height = static_cast<int>(height);
  figure.commands = script + plot_command(plot);
  return render_figure(figure, directory);
}

}  // namespace npdr::analysis
