#include "analysis/calibration_plot.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/analysis/drawn.h"

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
  const Drawn found = drawn(figure_of(ranks_of({"A", "B <&>"})));
  EXPECT_EQ(found.num_plots(), 2 * 4);  // band, even share, two methods
  EXPECT_TRUE(has(found.svg, {">mass<", ">pole_length<", ">A<", ">B &lt;&amp;><"}));
  const std::string& data = found.data.at("ranks_1.dat");
  EXPECT_EQ(data.substr(data.find('\n') + 1), "0 1.5 0.5\n0.5 0.5 1.5\n1 0.5 1.5\n")
      << "shares over the even one";
}

TEST(CalibrationPlot, DrawsCurvesOfCoverageInOneColorAMethod) {
  const Vector level = Vector::LinSpaced(11, 0.0, 1.0);
  const Drawn found =
      drawn(figure_of(CoveragePlot{"coverage",
                                   {{"highest density", {{"A", level, level}, {"B", level, level}}},
                                    {"2", {{"B", level, level}}}},
                                   100}));
  EXPECT_EQ(found.num_plots(), 4 + 3);  // band, diagonal and methods
  EXPECT_TRUE(has(found.svg, ">highest density<"));
  EXPECT_TRUE(has(found.script, "'coverage_3.dat' using 1:2 with lines lw 1.6 lc rgb '#00e69f00'"));
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
