#include "analysis/metrics.h"

#include <cmath>
#include <limits>
#include <tuple>

#include "analysis/dtw.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "tests/message_of.h"
#include "tests/thread_count.h"

namespace npdr::analysis {
namespace {

// Two rollouts of T = 3 steps and two channels. The last states are large on purpose: they must not
// count, neither in the maximum nor in the error.
Target small_target() {
  Target target;
  target.dt = 0.1;
  target.state_channels = {{"angle", "rad"}, {"rate", "rad/s"}};
  target.action_channels = {{"torque", "N m"}};
  RowMatrix first(4, 2), second(4, 2);
  first << 0, 0, 2, 4, -1, 8, 100, 100;
  second << 0, 0, 1, 1, 1, 1, 100, 100;
  target.rollouts = {{"first", first, RowMatrix::Zero(3, 1)},
                     {"second", second, RowMatrix::Zero(3, 1)}};
  return target;
}

TrajectoryView view_of(const std::vector<float>& values, Index samples) {
  return {values, samples, 2, 3, 2};
}

// States after actions 1, 2, 3 of both rollouts; the last ones don't count.
const std::vector<float> kSimulated = {2, 4, 1, 0, 7, 7, 1, 1, 1, 3, 7, 7};

// Rollout 1: maxima (2, 8). Simulated (0, 0), (2, 4), (1, 0): errors 0, 0, (2/2, -8/8) = (1, -1).
//   per channel sqrt((0 + 0 + 1) / 3), mean over channels sqrt(1/3)
// Rollout 2: maxima (1, 1). Simulated (0, 0), (1, 1), (1, 3): errors 0, 0, (0, 2).
//   channel 1: 0, channel 2: sqrt(4 / 3), mean sqrt(4 / 3) / 2 = sqrt(1/3)
// Mean over rollouts: sqrt(1/3). First channel only: rollout 1 sqrt(1/3), rollout 2 zero. With a
// restart before action 3, the last compared state is the recorded one.
TEST(Metrics, RmseMatchesACaseWorkedByHand) {
  const auto rmse = [](const MetricsConfig& config) {
    return Metrics(small_target(), config).rmse(view_of(kSimulated, 1))(0);
  };
  EXPECT_NEAR(rmse({}), std::sqrt(1.0 / 3.0), 1e-15);
  EXPECT_NEAR(rmse({{0}, 0}), std::sqrt(1.0 / 3.0) / 2, 1e-15);
  EXPECT_EQ(rmse({{}, 2}), 0.0);
}

// The states after the last action: recorded (100, 100) twice, simulated (97, 96) and (100, 99), in
// SI.
TEST(Metrics, FinalErrorIsTheMeanDistanceOfTheLastStates) {
  const std::vector<float> simulated = {2, 4, 1, 0, 97, 96, 1, 1, 1, 3, 100, 99};
  EXPECT_NEAR(Metrics(small_target()).final_error(view_of(simulated, 1))(0), (5.0 + 1.0) / 2,
              1e-12);
  MetricsConfig config;
  config.channels = {1};
  EXPECT_NEAR(Metrics(small_target(), config).final_error(view_of(simulated, 1))(0), 2.5, 1e-12);
}

// Over the last step of 0.1 s, rollout 1 moves by 5 and rollout 2 by 1.
TEST(Metrics, GoalIsTheShareOfTheRolloutsThatComeToRestThere) {
  const std::vector<float> simulated = {2, 4, 93, 93, 97, 96, 1, 1, 100, 98, 100, 99};
  const Vector place = Eigen::Vector2d(100, 100);
  for (const auto& [goal, share] : {std::pair{Goal{"", {0, 1}, place, 0.5, 60.0}, 0.0},
                                    {Goal{"", {0, 1}, place, 2.0, 60.0}, 0.5},
                                    {Goal{"", {0, 1}, place, 5.0, 60.0}, 1.0},
                                    {Goal{"", {0}, Vector::Constant(1, 97.0), 0.1, 60.0}, 0.5},
                                    {Goal{"", {0, 1}, place, 5.0, 40.0}, 0.5},
                                    {Goal{"", {0, 1}, place, 5.0, 5.0}, 0.0}}) {
    EXPECT_EQ(Metrics(small_target()).goal(view_of(simulated, 1), goal)(0), share);
  }
}

// The last of three steps begins a segment: in the recorded state.
TEST(Metrics, SpeedAtTheEndIsThatFromWhereTheSegmentBegan) {
  const RowMatrix recorded = small_target().rollouts.front().states;
  std::vector<float> simulated(12, 0.0f);
  for (std::size_t c = 0; c < 2; ++c) {
    simulated[4 + c] = simulated[10 + c] = static_cast<float>(recorded(2, static_cast<Index>(c)));
  }
  const Goal rest{"", {0, 1}, recorded.row(2).transpose(), 1.0, 1e-3};
  MetricsConfig config;
  EXPECT_EQ(Metrics(small_target(), config).goal(view_of(simulated, 1), rest)(0), 0.0);
  config.segment_length = 2;
  EXPECT_GE(Metrics(small_target(), config).goal(view_of(simulated, 1), rest)(0), 0.5);
}

TEST(Metrics, FailedRolloutsHaveNoEnd) {
  std::vector<float> simulated = kSimulated;
  simulated[3] = kFloatNaN;
  const Metrics metrics(small_target());
  EXPECT_TRUE(std::isnan(metrics.final_error(view_of(simulated, 1))(0)));
  EXPECT_TRUE(
      std::isnan(metrics.goal(view_of(simulated, 1), {"", {0}, Vector::Zero(1), 1.0, 1.0})(0)));
}

TEST(Metrics, AFailedSampleIsNanAndTheOthersAreNot) {
  std::vector<float> simulated(4 * 12, 1.0f);
  simulated[12 + 5] = kFloatNaN;
  simulated[24] = std::numeric_limits<float>::infinity();
  MetricsConfig config;
  config.channels = {0};  // the NaN is in the other channel
  const Metrics metrics(small_target(), config);
  for (const Vector& values :
       {metrics.rmse(view_of(simulated, 4)), metrics.dtw(view_of(simulated, 4))}) {
    EXPECT_TRUE(std::isfinite(values(0)));
    EXPECT_TRUE(std::isnan(values(1)));
    EXPECT_TRUE(std::isnan(values(2)));
    EXPECT_EQ(values(3), values(0));
  }
}

// A target and simulated rollouts of random walks, (21 samples, 3 rollouts, 40 steps, 4 channels).
struct RandomCase {
  Target target;
  std::vector<float> simulated;
  TrajectoryView view() const { return {simulated, 21, 3, 40, 4}; }
};

RandomCase random_case() {
  RandomCase result;
  result.target.dt = 0.01;
  result.target.state_channels.resize(4, {"x", "m"});
  Stream stream({3, "metrics_test"});
  for (int h = 0; h < 3; ++h) {
    RowMatrix states(41, 4);
    for (double& v : states.reshaped()) v = stream.normal();
    result.target.rollouts.push_back({"r", states, RowMatrix::Zero(40, 0)});
  }
  result.simulated.resize(21 * 3 * 40 * 4);
  stream.fill_normal(result.simulated);
  return result;
}

TEST(Metrics, DtwIsTheMeanOverRolloutsOfTheDistancesOfNormalizedSeries) {
  const RandomCase test = random_case();
  const Vector distances = Metrics(test.target).dtw(test.view());
  for (Index i = 0; i < distances.size(); ++i) {
    double sum = 0.0;
    for (Index h = 0; h < 3; ++h) {
      RowMatrix recorded = test.target.rollouts[static_cast<std::size_t>(h)].states.topRows(40);
      RowMatrix simulated = recorded;
      simulated.bottomRows(39) = test.view().rollout(i, h).topRows(39).cast<double>();
      for (Index c = 0; c < 4; ++c) {
        const double scale = recorded.col(c).lpNorm<Eigen::Infinity>();
        recorded.col(c) /= scale;
        simulated.col(c) /= scale;
      }
      sum += dtw(recorded, simulated).distance;
    }
    EXPECT_DOUBLE_EQ(distances(i), sum / 3.0);
  }
}

TEST(Metrics, SameBitsForAnyThreadCountAndBatch) {
  const RandomCase test = random_case();
  const Metrics metrics(test.target);
  const TrajectoryView all = test.view();
  expect_same_for_any_thread_count([&] { return std::pair{metrics.rmse(all), metrics.dtw(all)}; });
  const Vector rmse = metrics.rmse(all), dtw = metrics.dtw(all);
  for (Index i = 0; i < all.num_samples; ++i) {
    const TrajectoryView one = {all.values.subspan(static_cast<std::size_t>(i * all.row_size()),
                                                   static_cast<std::size_t>(all.row_size())),
                                1, 3, 40, 4};
    EXPECT_EQ(metrics.rmse(one)(0), rmse(i));
    EXPECT_EQ(metrics.dtw(one)(0), dtw(i));
  }
}

std::string problem_of(const Target& target, const MetricsConfig& config) {
  return message_of<InputError>([&] { const Metrics metrics(target, config); });
}

TEST(Metrics, RejectWhatTheyCannotNormalizeAndWrongShapes) {
  Target still = small_target();
  still.rollouts[1].states.col(1).setZero();
  EXPECT_EQ(problem_of(still, {{0}, 0}), "");
  const std::vector<std::tuple<Target, MetricsConfig, std::string>> cases = {
      {still, {}, "channel 'rate' of recorded rollout 'second' is 0 throughout"},
      {small_target(), {{2}, 0}, "channel 2, must be in [0, 1]"},
      {small_target(), {{0, 0}, 0}, "channel 0 ('angle') is listed twice"},
      {small_target(), {{}, -1}, "segment_length = -1, must be >= 0"}};
  for (const auto& [target, config, said] : cases) {
    EXPECT_TRUE(says(problem_of(target, config), {"metrics: " + said}));
  }
  const std::vector<float> values(8);
  const Metrics metrics(small_target());
  EXPECT_THROW(metrics.rmse({values, 1, 1, 4, 2}), ShapeError);
  EXPECT_THROW(metrics.dtw({values, 2, 2, 2, 2}), ShapeError);
}

}  // namespace
}  // namespace npdr::analysis
