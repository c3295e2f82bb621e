// Figures that compare methods.

#include <cmath>

#include "analysis/calibration_plot.h"
#include "analysis/curve_plot.h"
#include "analysis/heat_map.h"
#include "analysis/interval_plot.h"
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

TEST(CurvePlot, RejectsWhatCantBeDrawn) {
  EXPECT_THROW(figure_of(curve_plot_of({})), InputError);
  EXPECT_THROW(figure_of(curve_plot_of({"1", "2", "3", "4", "5", "6", "7"})), InputError);
  CurvePlot other = curve_plot_of({"A"});
  other.curves.front().upper.resize(3);
  EXPECT_THROW(figure_of(other), ShapeError);
  other.curves.front() = {};
  EXPECT_THROW(figure_of(other), InputError);
}

HeatMapPlot heat_map_of(const std::vector<std::string>& methods) {
  HeatMapPlot plot;
  plot.name = "robustness";
  plot.x = {"pole_mass", "kg", (Vector(3) << 0.1, 0.2, 0.4).finished()};
  plot.y = {"gain", "1", (Vector(2) << 1, 2).finished()};
  plot.value_title = "mean return";
  plot.high = 10.0;
  RowMatrix values(3, 2);
  values << 1, 2, 3, 4, 5, 6;
  for (const std::string& method : methods) plot.maps.push_back({method, values});
  return plot;
}

TEST(HeatMap, DrawsAMapPerMethod) {
  const Drawn found = drawn(figure_of(heat_map_of({"A", "B", "C", "D <&>"})));  // two rows
  EXPECT_EQ(found.num_plots(), 4);
  EXPECT_TRUE(has(found.svg, {">A<", ">D &lt;&amp;><", ">pole mass [kg]<", ">gain<",
                              ">mean return<", ">0.4<"}));
  const std::string& data = found.data.at("robustness_1.dat");
  EXPECT_EQ(data.substr(data.find('\n') + 1), "0 0 1\n0 1 2\n1 0 3\n1 1 4\n2 0 5\n2 1 6\n")
      << "each point of the grid is a cell";
}

TEST(HeatMap, AMarkLiesBetweenItsNeighbors) {
  const auto script = [](double x, double y) {
    HeatMapPlot plot = heat_map_of({"A"});
    plot.mark = {x, y};
    return drawn(figure_of(plot)).script;
  };
  EXPECT_TRUE(has(script(0.3, 1.25), "first 1.5, first 0.25"));
  EXPECT_TRUE(has(script(0.1, 2.0), "first 0, first 1"));
  EXPECT_FALSE(has(script(0.5, 1.0), "first")) << "outside of the grid";
}

TEST(HeatMap, LabelsAsManyCellsAsThereIsRoomFor) {
  HeatMapPlot plot = heat_map_of({"A"});
  plot.x.points = Vector::LinSpaced(40, 0.1001, 0.4991);
  plot.maps.front().values = RowMatrix::Constant(40, 2, std::nan(""));
  const std::string svg = drawn(figure_of(plot)).svg;
  EXPECT_LE(count_of(svg, ">0."), 5);
  EXPECT_TRUE(has(svg, ">0.1001<"));
}

TEST(HeatMap, RejectsWhatCantBeDrawn) {
  EXPECT_THROW(figure_of(heat_map_of({})), InputError);
  HeatMapPlot other = heat_map_of({"A"});
  other.maps.front().values.resize(2, 3);
  EXPECT_THROW(figure_of(other), ShapeError);
  other = heat_map_of({"A"});
  other.high = other.low;
  EXPECT_THROW(figure_of(other), InputError);
}

IntervalPlot interval_plot_of(std::size_t num_sets) {
  IntervalPlot plot{.name = "intervals",
                    .title = "place",
                    .parameters = {"pole_mass", "pole_length"},
                    .tips = {"pole_mass [kg]\nA: 1 & more", "tip 2"},
                    .sets = {},
                    .points = {}};
  RowMatrix quantiles(2, 5);
  quantiles << 0.1, 0.2, 0.3, 0.4, 0.5, 0.4, 0.5, 0.6, 0.7, 0.8;
  for (std::size_t set = 0; set < num_sets; ++set) {
    plot.sets.push_back({"set " + std::to_string(set), quantiles});
  }
  plot.points.push_back({"nominal", Vector{{0.5, 1.5}}, LegendMark::triangle, kNominalColor});
  return plot;
}

TEST(IntervalPlot, DrawsTheRowsAndBothIntervalsOfEachSetWithTips) {
  const Drawn found = drawn(figure_of(interval_plot_of(2)));
  EXPECT_EQ(found.num_plots(), 1 + 2 * 2);
  EXPECT_TRUE(has(found.svg, {">pole mass<", ">pole length<", ">set 1<", ">nominal<",
                              "<title>pole_mass [kg]\nA: 1 &amp; more</title>"}));
  EXPECT_EQ(count_of(found.svg, "<rect class=\"tip\""), 2);
  const std::string& wide = found.data.at("intervals_2.dat");
  EXPECT_TRUE(has(wide, "\n0.1 1.73")) << "the first row is above";
  EXPECT_TRUE(has(wide, " 0.4 0\n")) << "and as long as the interval";
  EXPECT_TRUE(has(found.data.at("intervals_3.dat"), {"\n0.2 1.73", " 0.2 0\n"}));
}

TEST(IntervalPlot, FitsIntoAWidthThatIsGiven) {
  IntervalPlot plot = interval_plot_of(1);
  plot.width = 340.0;
  EXPECT_TRUE(has(drawn(figure_of(plot)).svg, "viewBox=\"0 0 340 "));
  plot.width = 100.0;
  EXPECT_FALSE(has(drawn(figure_of(plot)).svg, "viewBox=\"0 0 100 ")) << "rows can still be seen";
}

TEST(IntervalPlot, RejectsWhatCantBeDrawn) {
  EXPECT_THROW(figure_of(interval_plot_of(0)), InputError);
  EXPECT_THROW(figure_of(interval_plot_of(kMaxMethods + 1)), InputError);
  IntervalPlot plot = interval_plot_of(1);
  plot.sets[0].quantiles.conservativeResize(2, 4);
  EXPECT_THROW(figure_of(plot), ShapeError);
  plot = interval_plot_of(1);
  plot.points[0].place.resize(1);
  EXPECT_THROW(figure_of(plot), ShapeError);
  plot = interval_plot_of(1);
  plot.tips.pop_back();
  EXPECT_THROW(figure_of(plot), ShapeError);
}

}  // namespace
}  // namespace npdr::analysis
