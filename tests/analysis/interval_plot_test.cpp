#include "analysis/interval_plot.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/analysis/drawn.h"

namespace npdr::analysis {
namespace {

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
