#include "analysis/heat_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/analysis/drawn.h"

namespace npdr::analysis {
namespace {

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

}  // namespace
}  // namespace npdr::analysis
