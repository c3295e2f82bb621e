#include "analysis/curve_plot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/analysis/drawn.h"

namespace npdr::analysis {
namespace {

TEST(CurvePlot, ABandIsTheSpreadOfTheExperiments) {
  RowMatrix experiments(2, 3);
  experiments << 1, 2, 3, 4, 4, 4;
  const Curve curve = curve_of("A", Vector::LinSpaced(2, 0, 1), experiments);
  EXPECT_EQ(curve.mean, (Vector(2) << 2, 4).finished());
  EXPECT_EQ(curve.lower, (Vector(2) << 1, 4).finished());
  EXPECT_EQ(curve.upper, (Vector(2) << 3, 4).finished());
  const Curve one = curve_of("A", Vector::LinSpaced(2, 0, 1), experiments.leftCols(1));
  EXPECT_EQ(one.lower, one.mean);
  EXPECT_EQ(one.upper, one.mean);
  EXPECT_THROW(curve_of("A", Vector::LinSpaced(3, 0, 1), experiments), ShapeError);
}

CurvePlot curve_plot_of(const std::vector<std::string>& methods) {
  CurvePlot plot{"learning", "search iteration", "return", {}};
  const RowMatrix experiments = RowMatrix::Random(4, 2);
  for (const std::string& method : methods) {
    plot.curves.push_back(curve_of(method, Vector::LinSpaced(4, 1, 4), experiments));
  }
  return plot;
}

TEST(CurvePlot, DrawsABandAndACurveOfEachMethod) {
  const Drawn found = drawn(figure_of(curve_plot_of({"A", "B <&>"})));
  EXPECT_EQ(found.num_plots(), 4);
  EXPECT_TRUE(has(found.svg, {">A<", ">B &lt;&amp;><", ">search iteration<", ">return<"}));
}

TEST(CurvePlot, CopesWithConstantAndMissingValues) {
  for (const double value : {0.0, -3.0, std::nan("")}) {
    CurvePlot plot = curve_plot_of({"A"});
    Curve& curve = plot.curves.front();
    for (Vector* part : {&curve.mean, &curve.lower, &curve.upper}) part->setConstant(value);
    drawn(figure_of(plot));
  }
}

TEST(CurvePlot, RejectsWhatCantBeDrawn) {
  EXPECT_THROW(figure_of(curve_plot_of({})), InputError);
  EXPECT_THROW(figure_of(curve_plot_of({"1", "2", "3", "4", "5", "6", "7"})), InputError);
  CurvePlot other = curve_plot_of({"A"});
  other.curves.front().upper.resize(3);
  EXPECT_THROW(figure_of(other), ShapeError);
  other.curves.front() = {};
  EXPECT_THROW(figure_of(other), InputError);
}

}  // namespace
}  // namespace npdr::analysis
