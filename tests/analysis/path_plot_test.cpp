#include "analysis/path_plot.h"

#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/analysis/markup_check.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

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
  const TempFolder folder;
  PathPlot plot = path_plot_of({"A", "B <&>"});
  plot.held_out = {line()};
  const FigureFiles files = write_figure(figure_of(plot), folder.path());
  const std::string svg = read_text_file(files.svg);
  EXPECT_EQ(markup_error(svg), "");
  // Shapes, paths, fixed, held out and recorded in each of two panels.
  EXPECT_EQ(count_of(svg, "<g id=\"gnuplot_plot_"), 2 * 5);
  EXPECT_TRUE(has(
      svg, {">A<", ">B &lt;&amp;><", ">x [m]<", ">y [m]<", ">target domain, seen<", ">held out<"}));
  EXPECT_TRUE(is_png(read_text_file(files.png)));
}

TEST(PathPlot, TheTargetDomainIsSeenWhereNothingIsHeldOut) {
  const TempFolder folder;
  const std::string svg =
      read_text_file(write_figure(figure_of(path_plot_of({"A"})), folder.path()).svg);
  EXPECT_TRUE(has(svg, ">target domain<"));
  EXPECT_FALSE(has(svg, "held out"));
}

TEST(PathPlot, PolygonsEndWhereTheyBeginAndPathsDont) {
  const TempFolder folder;
  write_figure(figure_of(path_plot_of({"A"})), folder.path());
  EXPECT_EQ(read_text_file(folder.path() / "paths_outlines_1.dat"),
            "# x, y\n0.5 0.5\n0.75 0.5\n0.75 0.75\n0.5 0.75\n0.5 0.5\nNaN NaN\n");
  EXPECT_EQ(read_text_file(folder.path() / "paths_recorded.dat"),
            "# x, y\n0.1 0.1\n0.5 0.2\n0.9 0.9\nNaN NaN\n");
}

TEST(PathPlot, ScalesAreEqual) {
  const TempFolder folder;
  PathPlot plot = path_plot_of({"A"});
  const auto height = [&] {
    const std::string svg = read_text_file(write_figure(figure_of(plot), folder.path()).svg);
    return std::stod(svg.substr(svg.find("height=\"") + 8));
  };
  const double square_height = height();
  plot.fixed[0].col(1) *= 2.0;
  EXPECT_NEAR(height() - square_height, 420.0, 2.0);
}

TEST(PathPlot, CopesWithoutPaths) {
  const TempFolder folder;
  PathPlot plot = path_plot_of({"A"});
  plot.recorded.clear();
  plot.predictions[0] = {"A", {}, {}};
  EXPECT_EQ(markup_error(read_text_file(write_figure(figure_of(plot), folder.path()).svg)), "");
}

TEST(PathPlot, RejectsWhatItCantDraw) {
  EXPECT_TRUE(
      says(message_of<InputError>([&] { figure_of(path_plot_of({})); }),
           {"path plot 'paths': 0 methods and 1 fixed polygons", "must be 1 to 6 and at least 1"}));
  PathPlot plot = path_plot_of({"A"});
  plot.recorded = {RowMatrix::Zero(3, 3)};
  EXPECT_TRUE(says(message_of<ShapeError>([&] { figure_of(plot); }),
                   {"path plot 'paths': 3 points of 3 coordinates", "must be at least 1 of 2"}));
  plot.recorded = {RowMatrix::Zero(0, 2)};
  EXPECT_THROW(figure_of(plot), ShapeError);
}

}  // namespace
}  // namespace npdr::analysis
