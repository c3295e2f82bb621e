// Figures of motions.

#include <cmath>

#include "analysis/path_plot.h"
#include "analysis/trajectory_plot.h"
#include "core/constants.h"
#include "core/error.h"
#include "tests/analysis/drawn.h"

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

// H rollouts of 40 steps and two channels.
Target target_of(Index num_rollouts) {
  Target target;
  target.dt = 0.05;
  target.state_channels = {{"angle", "rad"}, {"angle_dot", "rad/s"}};
  for (Index h = 0; h < num_rollouts; ++h) {
    RowMatrix states(41, 2);
    for (Index t = 0; t < 41; ++t) {
      states(t, 0) = std::sin(0.1 * static_cast<double>(t + h));
      states(t, 1) = std::cos(0.1 * static_cast<double>(t + h));
    }
    target.rollouts.push_back({"rollout_" + std::to_string(h), states, RowMatrix::Zero(40, 0)});
  }
  return target;
}

// A prediction around the recording.
Prediction prediction_of(const std::string& name, const Target& target, Index store_every = 1) {
  Prediction prediction{name, {}};
  for (const Rollout& rollout : target.rollouts) {
    RowMatrix median(target.num_steps() / store_every, 2);
    for (Index t = 0; t < median.rows(); ++t) {
      median.row(t) = rollout.states.row((t + 1) * store_every);
    }
    prediction.bands.median.push_back(median);
    prediction.bands.lower.emplace_back(median.array() - 0.1);
    prediction.bands.upper.emplace_back(median.array() + 0.2);
  }
  prediction.bands.num_samples = 12;
  return prediction;
}

TEST(TrajectoryPlot, DrawsAPanelPerChannelAndRollout) {
  const Target target = target_of(2);
  const TrajectoryPlot plot{"motion", {prediction_of("A", target), prediction_of("B <&>", target)}};
  const Drawn found = drawn(figure_of(plot, target));
  // Four panels: two bands, two medians and the recording in each; every plot is a group.
  EXPECT_EQ(found.num_plots(), 4 * 5);
  EXPECT_TRUE(
      has(found.svg, {">rollout_0<", ">rollout_1<", ">angle [rad]<", ">angle dot<", ">[rad/s]<",
                      ">time [s]<", ">target domain<", ">A: median, 90 % of 12 samples<",
                      ">B &lt;&amp;>: median, 90 % of 12 samples<"}));
}

TEST(TrajectoryPlot, DataHoldRecordedAndPredictedSideBySide) {
  const Target target = target_of(1);
  TrajectoryPlot plot{"motion", {prediction_of("A", target, 2)}};
  plot.store_every = 2;
  plot.channels = {1};
  plot.max_points = 10;  // of 20 stored states: every second
  const std::string data = drawn(figure_of(plot, target)).data.at("motion_rollout_0.dat");
  EXPECT_EQ(count_of(data, "\n"), 11);
  EXPECT_TRUE(
      data.starts_with("# rollout_0: time [s]; angle_dot [rad/s] recorded, A lower median "
                       "upper\n0.1 "))
      << data;
  // The second line is stored state 2, that is recorded state 6, at 0.3 s.
  const double value = std::cos(0.6);
  double time = 0.0, recorded = 0.0, lower = 0.0, median = 0.0, upper = 0.0;
  const std::string line = data.substr(data.find("\n0.30") + 1);
  ASSERT_EQ(
      std::sscanf(line.c_str(), "%lf %lf %lf %lf %lf", &time, &recorded, &lower, &median, &upper),
      5);
  EXPECT_NEAR(time, 0.3, 1e-12);
  EXPECT_NEAR(recorded, value, 1e-12);
  EXPECT_NEAR(lower, value - 0.1, 1e-12);
  EXPECT_NEAR(median, value, 1e-12);
  EXPECT_NEAR(upper, value + 0.2, 1e-12);
}

TEST(TrajectoryPlot, ShowsTheFirstSixRolloutsOrTheSelectedOnes) {
  const Target target = target_of(7);
  TrajectoryPlot plot{"motion", {}};
  const Drawn first = drawn(figure_of(plot, target));
  EXPECT_EQ(first.num_plots(), 6 * 2);
  EXPECT_FALSE(has(first.svg, ">rollout_6<"));
  plot.rollouts = {6};
  const Drawn selected = drawn(figure_of(plot, target));
  EXPECT_TRUE(has(selected.svg, ">rollout_6<"));
  EXPECT_EQ(selected.num_plots(), 2);
}

// A constant recorded channel has no range of its own, and bands may be wild or missing.
TEST(TrajectoryPlot, CopesWithConstantSeriesAndWildBands) {
  Target target = target_of(1);
  target.rollouts[0].states.col(0).setZero();
  Prediction wild = prediction_of("wild", target);
  wild.bands.upper[0](5, 1) = 1e12;
  Prediction missing = prediction_of("missing", target);
  for (auto* part : {&missing.bands.lower, &missing.bands.median, &missing.bands.upper}) {
    (*part)[0].setConstant(kNaN);
  }
  const Drawn found = drawn(figure_of(TrajectoryPlot{"motion", {wild, missing}}, target));
  // The range of the second row reaches no further than its own size beyond the recording.
  EXPECT_FALSE(has(found.script, "e+"));
}

TEST(TrajectoryPlot, RejectsWhatItCannotShow) {
  const Target target = target_of(2);
  using Change = void (*)(TrajectoryPlot&);
  const auto changed = [&](Change change) {
    TrajectoryPlot plot{"motion", {prediction_of("A", target)}};
    change(plot);
    return plot;
  };
  for (const Change change : std::initializer_list<Change>{
           [](TrajectoryPlot& plot) { plot.rollouts = {2}; },
           [](TrajectoryPlot& plot) { plot.channels = {-1}; },
           [](TrajectoryPlot& plot) { plot.channels.assign(13, 0); },
           [](TrajectoryPlot& plot) { plot.predictions.assign(7, plot.predictions[0]); },
           [](TrajectoryPlot& plot) { plot.store_every = 0; }}) {
    EXPECT_THROW(figure_of(changed(change), target), InputError);
  }
  for (const Change change : std::initializer_list<Change>{
           [](TrajectoryPlot& plot) { plot.store_every = 2; },
           [](TrajectoryPlot& plot) { plot.predictions[0].bands.upper.pop_back(); }}) {
    EXPECT_THROW(figure_of(changed(change), target), ShapeError);
  }
}

}  // namespace
}  // namespace npdr::analysis
