#include "analysis/calibration_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/file_stem.h"
#include "analysis/plot_layout.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// Sizes in pixels.
constexpr double kPanel = 230.0;
constexpr double kLeft = 58.0;
constexpr double kTop = 8.0;
constexpr double kLegendLine = 19.0;
constexpr double kTitle = 24.0;
constexpr double kBottom = 46.0;
constexpr double kGap = 48.0;
constexpr double kRight = 16.0;
constexpr double kFont = 11.0;
constexpr Index kPanelsPerRow = 4;

constexpr double kBand = 2.5758;  // normal deviations on either side that hold 99 %
constexpr const char* kBandColor = "#dddddd";

void require(bool good, const std::string& name, const std::string& words) {
  if (!good) throw InputError(fmt::format("calibration plot '{}': {}", name, words));
}

void check(const RankPlot& plot) {
  check_file_stem("calibration plot", plot.name);
  require(!plot.methods.empty() && plot.methods.size() <= kMaxMethods && !plot.parameters.empty(),
          plot.name, fmt::format("must have 1 to {} methods and a parameter", kMaxMethods));
  for (const RankCounts& method : plot.methods) {
    if (method.counts.cols() != static_cast<Index>(plot.parameters.size())) {
      throw ShapeError(fmt::format("calibration plot '{}': counts of {} parameters, must be {}",
                                   plot.name, method.counts.cols(), plot.parameters.size()));
    }
    require(method.counts.size() > 0 && method.counts.colwise().sum().minCoeff() > 0.0, plot.name,
            "must have ranks");
  }
}

void check(const CoveragePlot& plot) {
  check_file_stem("calibration plot", plot.name);
  require(!plot.panels.empty() && plot.num_truths > 0, plot.name, "must have panels and truths");
  for (const CoveragePanel& panel : plot.panels) {
    require(!panel.curves.empty() && panel.curves.size() <= kMaxMethods, plot.name,
            fmt::format("must have 1 to {} curves in a panel", kMaxMethods));
    for (const CoverageCurve& curve : panel.curves) {
      if (curve.level.size() == curve.coverage.size()) continue;
      throw ShapeError(fmt::format("calibration plot '{}': {} levels, {} coverages", plot.name,
                                   curve.level.size(), curve.coverage.size()));
    }
  }
}

// Panels in rows, a legend above them all.
class Grid {
 public:
  Grid(Index num_panels, std::vector<std::string> methods)
      : columns_(std::min(num_panels, kPanelsPerRow)),
        rows_((num_panels + kPanelsPerRow - 1) / kPanelsPerRow),
        methods_(std::move(methods)) {}

  double width() const {
    const double panels = static_cast<double>(columns_) * (kPanel + kGap) - kGap;
    return std::max(kLeft + panels + kRight, kLeft + legend_width());
  }
  double height() const {
    return kTop + kLegendLine + static_cast<double>(rows_) * (kTitle + kPanel + kBottom);
  }

  std::string begin() const {
    const PlotLayout layout(width(), height());
    std::string script =
        "set multiplot\nunset key\nset border 31 lw 0.8 lc rgb '#555555'\nset tics scale 0.5\n";
    double x = kLeft;
    for (std::size_t k = 0; k < methods_.size(); ++k) {
      script += legend_commands(layout, entry(k), x, kTop + 0.5 * kLegendLine, kFont);
      x += legend_entry_width(entry(k), kFont) + 2.0 * kFont;
    }
    return script;
  }

  // What stands around panel i.
  std::string frame(Index i, const std::string& title, const std::string& x_title,
                    const std::string& y_title) const {
    const PlotLayout layout(width(), height());
    const Panel area{kLeft + static_cast<double>(i % kPanelsPerRow) * (kPanel + kGap),
                     kTop + kLegendLine + kTitle +
                         static_cast<double>(i / kPanelsPerRow) * (kTitle + kPanel + kBottom),
                     kPanel, kPanel};
    const double middle = area.left + 0.5 * kPanel;
    std::string script = layout.margins(area);
    script +=
        layout.text(middle, area.top - 0.5 * kTitle, elide_text(title, kPanel, kFont), "center");
    script += layout.text(middle, area.top + kPanel + 0.75 * kBottom, x_title, "center");
    if (i % kPanelsPerRow == 0) {
      script += layout.text(0.25 * kLeft, area.top + 0.5 * kPanel, y_title, "center rotate by 90");
    }
    return script;
  }

 private:
  LegendEntry entry(std::size_t k) const {
    return {LegendMark::line, kMethodColors[k], methods_[k]};
  }
  double legend_width() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < methods_.size(); ++k) {
      sum += legend_entry_width(entry(k), kFont) + 2.0 * kFont;
    }
    return sum;
  }

  Index columns_, rows_;
  std::vector<std::string> methods_;
};

FigureFiles render(const std::string& name, const Grid& grid, const std::string& panels,
                   const std::filesystem::path& directory) {
  Figure figure;
  figure.name = name;
  figure.width = static_cast<int>(grid.width());
  figure.height = static_cast<int>(grid.height());
  figure.commands = grid.begin() + panels + "unset multiplot\n";
  return render_figure(figure, directory);
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

FigureFiles write_rank_plot(const RankPlot& plot, const std::filesystem::path& directory) {
  check(plot);
  std::vector<std::string> methods;
  double highest = 0.0;
  for (std::size_t k = 0; k < plot.methods.size(); ++k) {
    methods.push_back(plot.methods[k].method);
    const RowMatrix stairs = staircase(plot.methods[k].counts);
    highest = std::max(highest, stairs.rightCols(stairs.cols() - 1).maxCoeff());
    write_data_file(directory / fmt::format("{}_{}.dat", plot.name, k + 1),
                    "left border of the bin, then for each parameter: share of ranks over the even "
                    "one",
                    stairs);
  }
  const double band = band_of(plot.methods.front().counts);
  const Grid grid(static_cast<Index>(plot.parameters.size()), methods);
  std::string script = fmt::format("set xrange [0:1]\nset yrange [0:{}]\nset xtics 0.5\n",
                                   1.1 * std::max(highest, 1.0 + band));
  for (std::size_t d = 0; d < plot.parameters.size(); ++d) {
    script += grid.frame(static_cast<Index>(d), plot.parameters[d], "rank / samples", "share");
    script += fmt::format(
        "set object 1 rectangle from 0,{} to 1,{} behind fc rgb '{}' fs solid noborder\n",
        std::max(0.0, 1.0 - band), 1.0 + band, kBandColor);
    script += "plot 1 with lines lw 0.8 lc rgb '#888888'";
    for (std::size_t k = 0; k < methods.size(); ++k) {
      script += fmt::format(", {} using 1:{} with steps lw 1.6 lc rgb '{}'",
                            gnuplot_string(fmt::format("{}_{}.dat", plot.name, k + 1)), d + 2,
                            kMethodColors[k]);
    }
    script += "\nunset label\nunset object\n";
  }
  return render(plot.name, grid, script, directory);
}

FigureFiles write_coverage_plot(const CoveragePlot& plot, const std::filesystem::path& directory) {
  check(plot);
  std::vector<std::string> methods;
  for (const CoverageCurve& curve : plot.panels.front().curves) methods.push_back(curve.method);
  const Grid grid(static_cast<Index>(plot.panels.size()), methods);
  const double width = kBand / std::sqrt(static_cast<double>(plot.num_truths));
  std::string script = "set xrange [0:1]\nset yrange [0:1]\nset xtics 0.5\nset ytics 0.5\n";
  for (std::size_t p = 0; p < plot.panels.size(); ++p) {
    script += grid.frame(static_cast<Index>(p), plot.panels[p].title, "level", "coverage");
    const std::string half = fmt::format("{}*sqrt($1*(1-$1))", width);
    script += fmt::format(
        "plot '+' using 1:($1-{0}):($1+{0}) with filledcurves fs solid noborder lc rgb '{1}'", half,
        kBandColor);
    script += ", x with lines lw 0.8 lc rgb '#888888'";
    for (std::size_t k = 0; k < plot.panels[p].curves.size(); ++k) {
      const CoverageCurve& curve = plot.panels[p].curves[k];
      const std::string file = fmt::format("{}_{}_{}.dat", plot.name, p + 1, k + 1);
      RowMatrix points(curve.level.size(), 2);
      points << curve.level, curve.coverage;
      write_data_file(directory / file, "level, coverage", points);
      script += fmt::format(", {} using 1:2 with lines lw 1.6 lc rgb '{}'", gnuplot_string(file),
                            kMethodColors[k]);
    }
    script += "\nunset label\n";
  }
  return render(plot.name, grid, script, directory);
}

}  // namespace npdr::analysis
