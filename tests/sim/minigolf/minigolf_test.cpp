#include "sim/minigolf/minigolf.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "sim/minigolf/arm.h"
#include "sim/minigolf/course.h"
#include "tests/message_of.h"
#include "tests/sim/angles.h"

namespace npdr::sim {
namespace {

// Table A4's prior, obstacles within half a turn, everything else nominal.
RowMatrix prior_draws(const Simulator& simulator, Index count) {
  constexpr std::array<std::array<double, 2>, 10> ranges = {{{0.014, 0.026},
                                                             {0.0025, 0.0075},
                                                             {0.0, 1.0},
                                                             {0.0, 5e-4},
                                                             {-0.08, 0.08},
                                                             {-0.08, 0.08},
                                                             {-0.08, 0.08},
                                                             {-0.08, 0.08},
                                                             {-kPi / 2, kPi / 2},
                                                             {-kPi / 2, kPi / 2}}};
  RowMatrix theta = complete_theta(simulator, {}).transpose().replicate(count, 1);
  for (Index i = 0; i < count; ++i) {
    Stream stream({1, "draws", 0, static_cast<std::uint64_t>(i), 0});
    for (std::size_t p = 0; p < ranges.size(); ++p) {
      const auto [lower, upper] = ranges[p];
      theta(i, static_cast<Index>(p)) = lower + (upper - lower) * stream.uniform();
    }
  }
  return theta;
}

void expect_same(std::span<const float> a, std::span<const float> b) {
  EXPECT_TRUE(std::ranges::equal(
      a, b, [](float x, float y) { return std::bit_cast<int>(x) == std::bit_cast<int>(y); }));
}

TEST(Minigolf, ARowDependsOnNothingButItsTheta) {
  const Minigolf simulator({.name = "minigolf"});
  const Target target = simulator.behave(complete_theta(simulator, {}), 2, 1);
  const RowMatrix theta = prior_draws(simulator, 24);
  omp_set_num_threads(2);
  const Trajectories together = simulator.replay(target, theta);
  omp_set_num_threads(1);
  const RowMatrix reversed = theta.colwise().reverse();
  const Trajectories backwards = simulator.replay(target, reversed);
  for (Index i = 0; i < theta.rows(); ++i) {
    EXPECT_EQ(together.status[std::size_t(i)], backwards.status[std::size_t(23 - i)]);
    expect_same(together.row(i), backwards.row(23 - i));
    expect_same(together.row(i), simulator.replay(target, theta.row(i)).row(0));
  }
  omp_set_num_threads(omp_get_num_procs());
}

TEST(Minigolf, AnObstacleTurnedByPiIsTheSame) {
  const Minigolf simulator({.name = "minigolf"});
  const Target target = simulator.behave(complete_theta(simulator, {}), 1, 1);
  RowMatrix theta = complete_theta(simulator, {}).transpose().replicate(2, 1);
  theta(1, parameter_index(simulator.info(), "obstacle1_dyaw")) += kPi;
  theta(1, parameter_index(simulator.info(), "obstacle2_dyaw")) -= kPi;
  const Trajectories result = simulator.replay(target, theta);
  // Rounding differs, and the path is sensitive where it touches an edge.
  EXPECT_LT((result.rollout(0, 0) - result.rollout(1, 0)).cwiseAbs().maxCoeff(), 2e-3f);
}

// The ball is the only body that moves by itself, and gravity and friction scale with its mass.
TEST(Minigolf, MassChangesNothing) {
  const Minigolf simulator({.name = "minigolf"});
  const Target target = simulator.behave(complete_theta(simulator, {}), 1, 1);
  RowMatrix theta = complete_theta(simulator, {}).transpose().replicate(2, 1);
  theta(1, parameter_index(simulator.info(), "ball_mass")) = 0.0075;
  const Trajectories result = simulator.replay(target, theta);
  EXPECT_LT((result.rollout(0, 0) - result.rollout(1, 0)).cwiseAbs().maxCoeff(), 1e-6f);
}

TEST(Minigolf, ABallInsideAnObstacleIsOutOfLimits) {
  const Minigolf simulator({.name = "minigolf"});
  const Target target = simulator.behave(complete_theta(simulator, {}), 1, 1);
  const Vector theta = complete_theta(
      simulator, {{"obstacle2_dx", kBallStartX - 0.6}, {"obstacle2_dy", kBallStartY - 1.2}});
  const Trajectories result = simulator.replay(target, theta.transpose());
  EXPECT_EQ(result.status[0], RolloutStatus::out_of_limits);
  EXPECT_TRUE(std::isnan(result.values.front()) && std::isnan(result.values.back()));
}

// Struck back by an obstacle that stands across its way, on ground without friction, the ball
// leaves by the open end of the course and reaches the edge of the ground.
TEST(Minigolf, ABallThatLeavesTheGroundSaysSo) {
  const Minigolf simulator({.name = "minigolf", .minigolf = {.linear_damping = 0.0}});
  const Target target = simulator.behave(complete_theta(simulator, {}), 1, 1);
  const Vector theta = complete_theta(simulator, {{"obstacle2_dyaw", kPi / 2 - 25.0 * kPi / 180.0},
                                                  {"obstacle2_dy", 0.1},
                                                  {"ball_restitution", 1.0},
                                                  {"ball_rolling_friction", 0.0},
                                                  {"ground_rolling_friction", 0.0},
                                                  {"ground_friction", 0.0}});
  const Trajectories result = simulator.replay(target, theta.transpose());
  EXPECT_EQ(result.status[0], RolloutStatus::left_scene);
  EXPECT_TRUE(std::isnan(result.values.front()) && std::isnan(result.values.back()));
}

TEST(Minigolf, ABallInsideTheClubIsOutOfLimits) {
  const Minigolf simulator({.name = "minigolf"});
  Target target = simulator.behave(complete_theta(simulator, {}), 1, 1);
  const Eigen::Vector3d head = head_pose(strike(0.0)).translation();
  const RowMatrix theta = complete_theta(simulator, {}).transpose();
  target.rollouts[0].states.row(0) << head.x() + 0.02, head.y();
  EXPECT_EQ(simulator.replay(target, theta).status[0], RolloutStatus::out_of_limits);
  target.rollouts[0].states.row(0) << head.x() + 0.03, head.y();
  EXPECT_EQ(simulator.replay(target, theta).status[0], RolloutStatus::ok);
}

TEST(Minigolf, RejectsAbsurdRecordings) {
  const Minigolf simulator({.name = "minigolf"});
  const Target target = simulator.behave(complete_theta(simulator, {}), 1, 1);
  const auto problem_of = [&](const Target& absurd) {
    return message_of<InputError>(
        [&] { simulator.replay(absurd, complete_theta(simulator, {}).transpose()); });
  };
  Target fast = target;
  fast.dt = 1e-17;
  EXPECT_TRUE(says(problem_of(fast), {"simulated by 'minigolf': dt = 1e-17 s",
                                      "must be between 0.0001 and 1 s for 'minigolf'"}));
  Target far = target;
  far.rollouts[0].actions(7, 3) = -1e308;
  EXPECT_TRUE(says(problem_of(far), {"rollout 'simulated 0': a joint angle of 1e+308 rad",
                                     "must be within 100 rad"}));
}

// Whatever the strike and the start, a simulated target begins where its ball does: no step moves
// the ball further than it rolls in 10 ms.
TEST(Minigolf, TargetsBeginWhereTheirBallDoes) {
  for (const Strike strike : {Strike::recorded, Strike::policy}) {
    for (const BallStart start : {BallStart::recorded, BallStart::nominal}) {
      const Minigolf simulator(
          {.name = "minigolf", .minigolf = {.strike = strike, .ball_start = start}});
      const Vector theta = complete_theta(simulator, {});
      const Target target = simulator.behave(theta, 2, 3);
      for (const Rollout& rollout : target.rollouts) {
        EXPECT_LT((rollout.states.row(1) - rollout.states.row(0)).norm(), 1e-6)
            << name_of(strike) << name_of(start);
      }
      EXPECT_EQ(target.rollouts[0].states == target.rollouts[1].states,
                start == BallStart::nominal);
      const Trajectories again = simulator.replay(target, theta.transpose());
      EXPECT_LT((again.rollout(0, 1).cast<double>() - target.rollouts[1].states.bottomRows(800))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-6);
    }
  }
}

TEST(Minigolf, NanIsOutOfLimits) {
  const Minigolf simulator({.name = "minigolf"});
  const Target target = simulator.behave(complete_theta(simulator, {}), 1, 1);
  RowMatrix theta = complete_theta(simulator, {}).transpose();
  theta(0, 3) = std::nan("");
  EXPECT_EQ(simulator.replay(target, theta).status[0], RolloutStatus::out_of_limits);
}

TEST(Minigolf, KeepsEveryKthState) {
  const Minigolf all({.name = "minigolf"}), fourth({.name = "minigolf", .store_every = 4});
  const Target target = all.behave(complete_theta(all, {}), 1, 1);
  const RowMatrix theta = complete_theta(all, {}).transpose();
  const Trajectories every = all.replay(target, theta), some = fourth.replay(target, theta);
  ASSERT_EQ(some.num_steps, 200);
  for (Index t = 0; t < 200; ++t) {
    EXPECT_EQ(some.rollout(0, 0)(t, 0), every.rollout(0, 0)(4 * t + 3, 0));
  }
}

TEST(Minigolf, TakesStrikeAndStartFromWhereTheConfigSays) {
  const Minigolf recorded({.name = "minigolf"});
  const Minigolf policy({.name = "minigolf",
                         .minigolf = {.strike = Strike::policy, .ball_start = BallStart::nominal}});
  Target target = recorded.behave(complete_theta(recorded, {}), 1, 1);
  const RowMatrix theta = complete_theta(recorded, {}).transpose();
  const Trajectories before = policy.replay(target, theta);
  target.rollouts[0].states(0, 1) += 0.01;
  target.rollouts[0].actions.colwise() = target.rollouts[0].actions.col(0).eval();
  expect_same(policy.replay(target, theta).row(0), before.row(0));
}

TEST(Minigolf, RejectsSettingsThatCannotBe) {
  const auto problem_of = [](const SimulatorConfig& config) {
    return message_of<InputError>([&] { const Minigolf simulator(config); });
  };
  EXPECT_TRUE(says(problem_of({.name = "minigolf", .minigolf = {.substeps = 0}}),
                   {"simulator.minigolf.substeps = 0", "must be in [1, 1000]"}));
  EXPECT_TRUE(says(problem_of({.name = "minigolf", .segment_length = 100}),
                   {"simulator.segment_length = 100", "must be 0"}));
  EXPECT_TRUE(says(problem_of({.name = "minigolf", .minigolf = {.linear_damping = 1.5}}),
                   {"simulator.minigolf.linear_damping = 1.5", "must be in [0, 1]"}));
}

}  // namespace
}  // namespace npdr::sim
