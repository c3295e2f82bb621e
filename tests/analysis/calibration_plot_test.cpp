#include "analysis/calibration_plot.h"

#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/analysis/markup_check.h"
#include "tests/temp_folder.h"

namespace npdr::analysis {
namespace {

RankPlot ranks_of(const std::vector<std::string>& methods) {
  RankPlot plot{"ranks", {"mass", "pole_length"}, {}};
  RowMatrix counts(2, 2);
  counts << 30, 10, 10, 30;
  for (const std::string& method : methods) plot.methods.push_back({method, counts});
  return plot;
}

TEST(CalibrationPlot, DrawsAPanelPerParameter) {
  const TempFolder folder;
  const FigureFiles files = write_figure(figure_of(ranks_of({"A", "B <&>"})), folder.path());
  const std::string svg = read_text_file(files.svg);
  EXPECT_EQ(markup_error(svg), "");
  EXPECT_EQ(count_of(svg, "<g id=\"gnuplot_plot_"), 2 * 4);  // band, even share, two methods
  EXPECT_TRUE(has(svg, {">mass<", ">pole_length<", ">A<", ">B &lt;&amp;><"}));
  EXPECT_TRUE(is_png(read_text_file(files.png)));
}

TEST(CalibrationPlot, RanksAreSharesOverTheEvenOne) {
  const TempFolder folder;
  write_figure(figure_of(ranks_of({"A"})), folder.path());
  const std::string data = read_text_file(folder.path() / "ranks_1.dat");
  EXPECT_EQ(data.substr(data.find('\n') + 1), "0 1.5 0.5\n0.5 0.5 1.5\n1 0.5 1.5\n");
}

TEST(CalibrationPlot, DrawsCurvesOfCoverage) {
  const TempFolder folder;
  const Vector level = Vector::LinSpaced(11, 0.0, 1.0);
  const CoveragePlot plot{
      "coverage", {{"highest density", {{"A", level, level}, {"B", level, level}}}}, 100};
  const std::string svg = read_text_file(write_figure(figure_of(plot), folder.path()).svg);
  EXPECT_EQ(markup_error(svg), "");
  EXPECT_EQ(count_of(svg, "<g id=\"gnuplot_plot_"), 4);  // band, diagonal and two methods
  EXPECT_TRUE(has(svg, ">highest density<"));
}

TEST(CalibrationPlot, AMethodHasOneColorInAllPanels) {
  const TempFolder folder;
  const Vector level = Vector::LinSpaced(11, 0.0, 1.0);
  const CoveragePlot plot{
      "coverage",
      {{"1", {{"A", level, level}, {"B", level, level}}}, {"2", {{"B", level, level}}}},
      9};
  const FigureFiles files = write_figure(figure_of(plot), folder.path());
  const std::string script = read_text_file(files.script);
  EXPECT_TRUE(has(script, "'coverage_3.dat' using 1:2 with lines lw 1.6 lc rgb '#00e69f00'"));
}

TEST(CalibrationPlot, RejectsWhatCantBeDrawn) {
  EXPECT_THROW(figure_of(ranks_of({})), InputError);
  RankPlot other = ranks_of({"A"});
  other.parameters.pop_back();
  EXPECT_THROW(figure_of(other), ShapeError);
  RankPlot none = ranks_of({"A"});
  none.methods.front().counts.setZero();
  EXPECT_THROW(figure_of(none), InputError);
  EXPECT_THROW(figure_of(CoveragePlot{"coverage", {}, 100}), InputError);
  const CoveragePlot uneven{"coverage", {{"p", {{"A", Vector::Zero(3), Vector::Zero(2)}}}}, 10};
  EXPECT_THROW(figure_of(uneven), ShapeError);
}

}  // namespace
}  // namespace npdr::analysis
