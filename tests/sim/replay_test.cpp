#include "sim/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/constants.h"
#include "core/random.h"
#include "sim/simulator.h"
#include "tests/thread_count.h"

namespace npdr::sim {
namespace {

std::unique_ptr<Simulator> furuta(const SimulatorConfig& settings = {}) {
  SimulatorConfig config = settings;
  config.name = "furuta";
  return make_simulator(config);
}

// A simulated Furuta domain of few steps.
Target short_target(Index rollouts = 2, Index steps = 60) {
  const auto simulator = furuta();
  Target target = simulator->behave(complete_theta(*simulator, {}), rollouts, 1);
  for (Rollout& rollout : target.rollouts) {
    rollout.states.conservativeResize(steps + 1, Eigen::NoChange);
    rollout.actions.conservativeResize(steps, Eigen::NoChange);
  }
  return target;
}

// Parameters of the extended study, around nominal.
RowMatrix random_thetas(Index count) {
  const auto simulator = furuta();
  RowMatrix theta = complete_theta(*simulator, {}).transpose().replicate(count, 1);
  for (Index i = 0; i < count; ++i) {
    Stream stream({1, "replay_test", 0, static_cast<std::uint64_t>(i), 0});
    for (Index p = 0; p < 9; ++p) theta(i, p) *= 0.8 + 0.4 * stream.uniform();
    theta(i, 9) = -0.4 * stream.uniform();
    theta(i, 10) = 0.4 * stream.uniform();
    theta(i, 11) = 6.0 * stream.uniform();
    theta(i, 12) = 2e-3 * stream.uniform();
    theta(i, 13) = 5e-3 * stream.uniform();
    theta(i, 14) = 0.6 * stream.uniform() - 0.3;
  }
  return theta;
}

// Rows that can't be simulated: no number, no mass, a motor too stiff for the step.
void spoil(RowMatrix& theta, Index row, int how) {
  if (how % 3 == 0) theta(row, 11) = kNaN;
  if (how % 3 == 1) theta.row(row).segment(4, 2).setZero();
  if (how % 3 == 2) theta(row, 3) = 1e4;
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

TEST(Replay, SameBitsForAnyThreadCount) {
  const Target target = short_target();
  const auto simulator = furuta({.segment_length = 25});
  RowMatrix theta = random_thetas(300);
  for (Index row = 0; row < 300; row += 40) spoil(theta, row, static_cast<int>(row / 40));
  const Trajectories serial = [&] {
    const ThreadCount one(1);
    return simulator->replay(target, theta);
  }();
  for (const int count : {2, 3, 4, 16}) {
    const ThreadCount threads(count);
    const Trajectories parallel = simulator->replay(target, theta);
    EXPECT_TRUE(same_bits(serial.values, parallel.values)) << count;
    EXPECT_EQ(serial.status, parallel.status) << count;
  }
}

TEST(Replay, SameBitsAloneInABatchAndAtAnyPosition) {
  const Target target = short_target();
  const RowMatrix theta = random_thetas(70);
  using enum Integrator;
  for (const Integrator integrator : {erk4, erk2, erk5, cvode}) {
    const auto simulator = furuta({.segment_length = 25, .integrator = integrator});
    const Trajectories all = simulator->replay(target, theta);
    const Trajectories reversed = simulator->replay(target, theta.colwise().reverse());
    for (Index i = 0; i < 70; ++i) {
      const Trajectories alone = simulator->replay(target, theta.row(i));
      ASSERT_TRUE(same_bits(all.row(i), alone.row(0))) << name_of(integrator) << " row " << i;
      ASSERT_TRUE(same_bits(all.row(i), reversed.row(69 - i)))
          << name_of(integrator) << " row " << i;
    }
  }
}

TEST(Replay, ARowThatDivergesIsMarkedAndLeavesItsNeighborsAlone) {
  const Target target = short_target();
  for (const Integrator integrator : {Integrator::erk4, Integrator::cvode}) {
    const auto simulator = furuta({.integrator = integrator});
    const RowMatrix healthy = random_thetas(24);
    RowMatrix theta = healthy;
    for (int how = 0; how < 3; ++how) spoil(theta, 3 + 5 * how, how);
    testing::internal::CaptureStderr();
    const Trajectories expected = simulator->replay(target, healthy);
    const Trajectories result = simulator->replay(target, theta);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    for (Index i = 0; i < 24; ++i) {
      const bool sick = i == 3 || i == 8 || (i == 13 && integrator != Integrator::cvode);
      if (i == 13 && !sick) continue;  // an adaptive integrator manages the stiff row
      const auto status = result.status[static_cast<std::size_t>(i)];
      ASSERT_EQ(status, sick ? RolloutStatus::diverged : RolloutStatus::ok)
          << name_of(integrator) << i;
      if (sick) {
        ASSERT_TRUE(std::ranges::all_of(result.row(i), [](float v) { return std::isnan(v); }));
      } else {
        ASSERT_TRUE(same_bits(result.row(i), expected.row(i))) << name_of(integrator) << i;
      }
    }
  }
}

TEST(Replay, ARolloutThatDivergesFailsTheWholeRowThoughLaterSegmentsRecover) {
  Target target = short_target(2, 60);
  target.rollouts[1].states(20, 2) = 1e38;  // a recorded state where only segment 1 starts
  const auto simulator = furuta({.segment_length = 20, .store_every = 60});
  const Trajectories result = simulator->replay(target, random_thetas(1));
  EXPECT_EQ(result.status[0], RolloutStatus::diverged);
  EXPECT_TRUE(std::isnan(result.rollout(0, 0)(0, 0)));
}

TEST(Replay, ReproducesASimulatedTargetAtItsTruth) {
  const auto simulator = furuta();
  const Vector truth = complete_theta(*simulator, {{"pole_length", 0.14}, {"action_delay", 1.5}});
  const Target target = simulator->behave(truth, 2, 3);
  const Trajectories result = simulator->replay(target, truth.transpose());
  for (Index h = 0; h < 2; ++h) {
    const RowMatrix& states = target.rollouts[static_cast<std::size_t>(h)].states;
    EXPECT_EQ(result.rollout(0, h), states.bottomRows(1250).cast<float>());
  }
}

TEST(Replay, SegmentsRestartFromTheRecordedStates) {
  const Target target = short_target(1, 60);
  Target later = target;  // what was recorded from step 25 on
  later.rollouts[0].states = target.rollouts[0].states.bottomRows(36);
  later.rollouts[0].actions = target.rollouts[0].actions.bottomRows(35);
  RowMatrix theta = random_thetas(3);
  theta.col(11).setZero();  // a delay would reach back to before step 25
  const Trajectories segments = furuta({.segment_length = 25})->replay(target, theta);
  const Trajectories whole = furuta()->replay(target, theta);
  const Trajectories tail = furuta({.segment_length = 25})->replay(later, theta);
  for (Index i = 0; i < 3; ++i) {
    EXPECT_EQ(segments.rollout(i, 0).topRows(25), whole.rollout(i, 0).topRows(25));
    EXPECT_EQ(segments.rollout(i, 0).bottomRows(35), tail.rollout(i, 0));
    EXPECT_NE(segments.rollout(i, 0).row(25), whole.rollout(i, 0).row(25));
  }
}

TEST(Replay, StoresEveryKthState) {
  const Target target = short_target(2, 60);
  const RowMatrix theta = random_thetas(3);
  const Trajectories all = furuta({.segment_length = 25})->replay(target, theta);
  const Trajectories some = furuta({.segment_length = 25, .store_every = 7})->replay(target, theta);
  ASSERT_EQ(some.num_steps, 8);
  for (Index t = 0; t < 8; ++t) {
    EXPECT_EQ(some.rollout(2, 1).row(t), all.rollout(2, 1).row(7 * t + 6));
  }
}

TEST(Replay, SubstepsRefineTheSolution) {
  const Target target = short_target(1, 60);
  const RowMatrix theta = complete_theta(*furuta(), {}).transpose();
  const auto final_angle = [&](const SimulatorConfig& config) {
    return double{furuta(config)->replay(target, theta).rollout(0, 0)(59, 1)};
  };
  const double exact = final_angle({.integrator = Integrator::cvode});
  const double coarse = std::abs(final_angle({.integrator = Integrator::erk2}) - exact);
  const double fine =
      std::abs(final_angle({.integrator = Integrator::erk2, .substeps = 8}) - exact);
  EXPECT_LT(fine, 0.1 * coarse);
}

TEST(Replay, OfNoRowsIsEmpty) {
  const Trajectories result = furuta()->replay(short_target(), RowMatrix(0, 15));
  EXPECT_EQ(result.num_rows, 0);
  EXPECT_TRUE(result.values.empty());
}

}  // namespace
}  // namespace npdr::sim
