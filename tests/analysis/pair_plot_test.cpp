#include "analysis/pair_plot.h"

#include <algorithm>
#include <sstream>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "tests/analysis/drawn.h"

namespace npdr::analysis {
namespace {

// Samples well inside the box [0, 2]^dimension.
RowMatrix samples(std::uint64_t row, Index n, Index dimension) {
  Stream stream({1, "pair_plot_test", 0, row, 0});
  RowMatrix values(n, dimension);
  for (double& v : values.reshaped()) v = 0.5 + stream.uniform();
  return values;
}

PairPlot pair_plot_of(Index dimension) {
  PairPlot plot;
  plot.name = "pairs";
  for (Index d = 0; d < dimension; ++d) {
    plot.parameters.push_back({"p_" + std::to_string(d), "kg", 0.0, 2.0});
  }
  plot.points = {{"nominal", Vector::Constant(dimension, 1.0), LegendMark::triangle, "#1b7837",
                  LineStyle::dashed},
                 {"truth", Vector::Constant(dimension, 1.5), LegendMark::diamond, "#000000",
                  LineStyle::solid}};
  plot.sets = {{"first", samples(1, 1000, dimension)}, {"second", samples(2, 500, dimension)}};
  return plot;
}

TEST(PairPlot, ShowsTheSamplesOfEverySetInEveryPanel) {
  const Drawn found = drawn(figure_of(pair_plot_of(3)));
  // Three panels off the diagonal of 200 points of two sets, and two dots of the legend; each of
  // the legend's dots has a white rim of its own.
  EXPECT_EQ(count_of(found.svg, "<circle cx="), 3 * 2 * 200 + 4);
  EXPECT_TRUE(
      has(found.svg, {">first<", ">second<", ">nominal<", ">truth<", ">p 0 [kg]<", ">p 2 [kg]<"}));
  EXPECT_EQ(count_of(found.data.at("pairs_samples_1.dat"), "\n"), 201);
  EXPECT_EQ(count_of(found.data.at("pairs_density_2.dat"), "\n"), 257);
}

TEST(PairPlot, ScattersEvenlyStridedSamplesOrAll) {
  PairPlot plot = pair_plot_of(2);
  plot.sets = {{"only", RowMatrix(10, 2)}};
  for (Index i = 0; i < 10; ++i) plot.sets[0].samples.row(i).setConstant(0.1 * (1.0 + double(i)));
  plot.num_points = 4;
  EXPECT_EQ(drawn(figure_of(plot)).data.at("pairs_samples_1.dat"),
            "# only, samples of p_0 [kg], p_1 [kg]\n"
            "0.1 0.1\n0.30000000000000004 0.30000000000000004\n0.6000000000000001 "
            "0.6000000000000001\n0.8 0.8\n");
  plot = pair_plot_of(2);
  plot.sets = {{"few", samples(1, 7, 2)}, {"none", RowMatrix(0, 2)}};
  EXPECT_EQ(count_of(drawn(figure_of(plot)).svg, "<circle cx="), 7 + 4);
}

TEST(PairPlot, LimitsAxesToThePriorAndLeavesOutMarksBeyond) {
  PairPlot plot = pair_plot_of(2);
  plot.sets = {{"outside", samples(1, 50, 2)}};
  plot.sets[0].samples.col(0).array() += 10.0;
  for (MarkedPoint& point : plot.points) point.place.setConstant(7.0);
  const std::string svg = drawn(figure_of(plot)).svg;
  EXPECT_EQ(count_of(svg, "<circle cx="), 2);  // the legend's
  EXPECT_FALSE(has(svg, "truth"));
}

TEST(PairPlot, ShowsTheSelectedParametersOrTheFirstFifteen) {
  PairPlot plot = pair_plot_of(20);
  plot.num_points = 5;
  EXPECT_EQ(count_of(drawn(figure_of(plot)).svg, "<circle cx="), 105 * 2 * 5 + 4);
  plot.selection = {17, 3};
  const std::string svg = drawn(figure_of(plot)).svg;
  EXPECT_TRUE(has(svg, {">p 17 [kg]<", ">p 3 [kg]<"}));
  EXPECT_FALSE(has(svg, ">p 4 [kg]<"));
}

// Commands of marginal c (from 0), in the order in which panels are drawn.
std::string marginal_commands(const std::string& script, int c) {
  std::size_t begin = script.find("unset ytics");
  for (int k = 0; k < c; ++k) begin = script.find("unset ytics", begin + 1);
  begin = script.rfind("set yrange", begin);
  return script.substr(begin, script.find("unset label", begin) - begin);
}

// A parameter that a method takes as known is a line, not a spike that flattens the others'
// densities; sets that lie outside of the box, in whole, leave an empty panel.
TEST(PairPlot, KeepsItsScaleWithConstantAndFarSamples) {
  PairPlot plot = pair_plot_of(3);
  plot.sets[1].samples.col(1).setConstant(0.75);
  plot.sets[0].samples.col(2).array() += 10.0;
  plot.sets[1].samples.col(2).array() -= 10.0;
  plot.sets[1].samples(0, 2) = kNaN;
  const std::string script = drawn(figure_of(plot)).script;
  const std::string line = "set arrow from first 0.75, graph 0 to first 0.75, graph 1 nohead front";
  EXPECT_FALSE(has(marginal_commands(script, 0), line));
  EXPECT_TRUE(has(marginal_commands(script, 1), line));
  EXPECT_TRUE(has(marginal_commands(script, 2), "set yrange [0:1.05]"));
}

// Largest number in a column of a data file.
double largest(const std::string& text, int column) {
  std::istringstream lines(text);
  std::string line;
  double most = 0.0;
  while (std::getline(lines, line)) {
    if (line.starts_with('#')) continue;
    std::istringstream numbers(line);
    double value = 0.0;
    for (int c = 0; c <= column; ++c) numbers >> value;
    most = std::max(most, value);
  }
  return most;
}

// A narrow density neither flattens a wide one nor is cut off.
TEST(PairPlot, DensitiesAreEquallyHigh) {
  PairPlot plot = pair_plot_of(2);
  plot.sets[1].samples.col(0) = 1.0 + 1e-3 * plot.sets[1].samples.col(0).array();
  const Drawn found = drawn(figure_of(plot));
  for (const char* name : {"pairs_density_1.dat", "pairs_density_2.dat"}) {
    EXPECT_EQ(largest(found.data.at(name), 1), 1.0) << name;
  }
}

TEST(PairPlot, DrawsASingleParameter) {
  EXPECT_EQ(drawn(figure_of(pair_plot_of(1))).num_plots(), 2 * 2);
}

TEST(PairPlot, RejectsWhatItCannotShow) {
  EXPECT_THROW(figure_of(pair_plot_of(0)), InputError);
  using Change = void (*)(PairPlot&);
  const auto changed = [](Change change) {
    PairPlot plot = pair_plot_of(2);
    change(plot);
    return plot;
  };
  for (const Change change : std::initializer_list<Change>{
           [](PairPlot& plot) { plot.selection.assign(16, 0); },
           [](PairPlot& plot) {
             plot.selection = {0, 2};
           },
           [](PairPlot& plot) { plot.sets.resize(7, plot.sets[0]); },
           [](PairPlot& plot) { plot.sets.clear(); }, [](PairPlot& plot) { plot.num_points = 0; },
           [](PairPlot& plot) { plot.parameters[1].upper = 0.0; }}) {
    EXPECT_THROW(figure_of(changed(change)), InputError);
  }
  for (const Change change :
       std::initializer_list<Change>{[](PairPlot& plot) { plot.sets[1].samples.resize(5, 3); },
                                     [](PairPlot& plot) { plot.points[0].place.resize(3); }}) {
    EXPECT_THROW(figure_of(changed(change)), ShapeError);
  }
}

}  // namespace
}  // namespace npdr::analysis
