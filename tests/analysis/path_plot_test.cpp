#include "analysis/path_plot.h"

#include <gtest/gtest.h>
#include <utility>

#include "core/error.h"
#include "tests/analysis/drawn.h"
#include "tests/message_of.h"

namespace npdr::analysis {
namespace {

RowMatrix square(double x, double y, double size) {
  RowMatrix points(4, 2);
  points << x, y, x + size, y, x + size, y + size, x, y + size;
  return points;
}

RowMatrix line() {
  RowMatrix points(3, 2);
  points << 0.1, 0.1, 0.5, 0.2, 0.9, 0.9;
  return points;
}

PathPlot path_plot_of(const std::vector<std::string>& methods) {
  PathPlot plot;
  plot.name = "paths";
  plot.fixed = {square(0.0, 0.0, 2.0)};
  plot.recorded = {line()};
  for (const std::string& method : methods) {
    plot.predictions.push_back({method, {line(), line()}, {square(0.5, 0.5, 0.25)}});
  }
  return plot;
}

TEST(PathPlot, DrawsAPanelPerMethod) {
  PathPlot plot = path_plot_of({"A", "B <&>"});
  plot.held_out = {line()};
  const Drawn found = drawn(figure_of(plot));
  // Shapes, paths, fixed, held out and recorded in each of two panels.
  EXPECT_EQ(found.num_plots(), 2 * 5);
  EXPECT_TRUE(has(found.svg, {">A<", ">B &lt;&amp;><", ">x [m]<", ">y [m]<",
                              ">target domain, seen<", ">held out<"}));
}

// Polygons end where they begin, and paths don't.
TEST(PathPlot, TheTargetDomainIsSeenWhereNothingIsHeldOut) {
  const Drawn found = drawn(figure_of(path_plot_of({"A"})));
  EXPECT_TRUE(has(found.svg, ">target domain<"));
  EXPECT_FALSE(has(found.svg, "held out"));
  EXPECT_EQ(found.data.at("paths_outlines_1.dat"),
            "# x, y\n0.5 0.5\n0.75 0.5\n0.75 0.75\n0.5 0.75\n0.5 0.5\nNaN NaN\n");
  EXPECT_EQ(found.data.at("paths_recorded.dat"), "# x, y\n0.1 0.1\n0.5 0.2\n0.9 0.9\nNaN NaN\n");
}

TEST(PathPlot, ScalesAreEqual) {
  PathPlot plot = path_plot_of({"A"});
  const auto height = [&] {
    const std::string svg = drawn(figure_of(plot)).svg;
    return std::stod(svg.substr(svg.find("height=\"") + 8));
  };
  const double square_height = height();
  plot.fixed[0].col(1) *= 2.0;
  EXPECT_NEAR(height() - square_height, 420.0, 2.0);
}

TEST(PathPlot, CopesWithoutPaths) {
  PathPlot plot = path_plot_of({"A"});
  plot.recorded.clear();
  plot.predictions[0] = {"A", {}, {}};
  drawn(figure_of(plot));
}

TEST(PathPlot, RejectsWhatItCantDraw) {
  EXPECT_THROW(figure_of(path_plot_of({})), InputError);
  PathPlot plot = path_plot_of({"A"});
  for (const auto& [rows, columns] : {std::pair{3, 3}, {0, 2}}) {
    plot.recorded = {RowMatrix::Zero(rows, columns)};
    EXPECT_THROW(figure_of(plot), ShapeError);
  }
}

}  // namespace
}  // namespace npdr::analysis
