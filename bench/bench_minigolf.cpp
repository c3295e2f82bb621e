/// Rollouts of 8 s per second and thread of the mini golf, and where their time goes.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "core/random.h"
#include "sim/minigolf/arm.h"
#include "sim/minigolf/ball_world.h"
#include "sim/simulator.h"

namespace npdr::sim {
namespace {

constexpr double kStep = 0.01;
constexpr Index kSteps = 800;
const Eigen::Vector2d kFarAway(-1.0, 1.3);

// Draws of Table A4's prior.
RowMatrix prior_draws(const Simulator& simulator, Index count) {
  constexpr double turn = std::numbers::pi / 2.0;
  constexpr std::array<double, 10> lower = {0.014, 0.0025, 0.0,   0.0,   -0.08,
                                            -0.08, -0.08,  -0.08, -turn, -turn};
  constexpr std::array<double, 10> upper = {0.026, 0.0075, 1.0,  5e-4, 0.08,
                                            0.08,  0.08,   0.08, turn, turn};
  RowMatrix theta = complete_theta(simulator, {}).transpose().replicate(count, 1);
  Stream stream({1, "bench_minigolf", 0, 0, 0});
  for (Index i = 0; i < count; ++i) {
    for (std::size_t p = 0; p < lower.size(); ++p) {
      theta(i, static_cast<Index>(p)) = lower[p] + (upper[p] - lower[p]) * stream.uniform();
    }
  }
  return theta;
}

ClubMotion strike_motion(const MinigolfConfig& config) {
  return {strike_actions(kSteps, kStep), config.substeps, config.substeps_near};
}

// Argument: substeps_near.
void replay(benchmark::State& state, Rolling rolling) {
  omp_set_num_threads(1);
  SimulatorConfig config{.name = "minigolf"};
  config.minigolf.rolling = rolling;
  config.minigolf.substeps_near = state.range(0);
  const auto simulator = make_simulator(config);
  const Target target = simulator->behave(complete_theta(*simulator, {}), 1, 1);
  const RowMatrix theta = prior_draws(*simulator, 512);
  for (auto _ : state) benchmark::DoNotOptimize(simulator->replay(target, theta));
  state.counters["rollouts/s"] = benchmark::Counter(static_cast<double>(theta.rows()),
                                                    benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(replay, exact, Rolling::exact)
    ->ArgName("substeps_near")
    ->Arg(2)
    ->Arg(5)
    ->Arg(10)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, engine, Rolling::engine)
    ->ArgName("substeps_near")
    ->Arg(5)
    ->Unit(benchmark::kMillisecond);

// The profile: how many steps of a rollout go which way, over the prior. Times of one are below.
void steps_of_a_rollout(benchmark::State& state) {
  const MinigolfConfig config;
  const auto simulator = make_simulator({.name = "minigolf"});
  const RowMatrix theta = prior_draws(*simulator, 512);
  const ClubMotion motion = strike_motion(config);
  double rolled = 0.0, coarse = 0.0, fine = 0.0, begun = 0.0;
  for (auto _ : state) {
    for (Index i = 0; i < theta.rows(); ++i) {
      const Course course = course_at(theta.row(i));
      if (begins_inside(course, kBallStartX, kBallStartY)) continue;
      BallWorld world(config, course, motion, kStep, {kBallStartX, kBallStartY});
      for (Index t = 0; t < kSteps && !world.has_come_to_rest(); ++t) {
        world.step(t);
        const Eigen::Vector3d ball = world.ball_position();
        if (!is_on_ground(ball.x(), ball.y())) break;
      }
      begun += 1.0;
      rolled += static_cast<double>(world.step_counts().rolled);
      coarse += static_cast<double>(world.step_counts().coarse);
      fine += static_cast<double>(world.step_counts().fine);
    }
  }
  state.counters["rolled"] = rolled / begun;
  state.counters["coarse"] = coarse / begun;
  state.counters["fine"] = fine / begun;
}
BENCHMARK(steps_of_a_rollout)->Unit(benchmark::kMillisecond)->Iterations(1);

void make_world(benchmark::State& state) {
  const MinigolfConfig config;
  const ClubMotion motion = strike_motion(config);
  const auto simulator = make_simulator({.name = "minigolf"});
  const Course course = course_at(complete_theta(*simulator, {}).transpose());
  for (auto _ : state) {
    BallWorld world(config, course, motion, kStep, {kBallStartX, kBallStartY});
    benchmark::DoNotOptimize(world.ball_position());
  }
}
BENCHMARK(make_world)->Unit(benchmark::kMicrosecond);

// One step of 10 ms of a ball at `place` that rolls slowly; the club is far away.
void step(benchmark::State& state, Rolling rolling, const Eigen::Vector2d& place) {
  MinigolfConfig config;
  config.rolling = rolling;
  const ClubMotion motion = strike_motion(config);
  const auto simulator = make_simulator({.name = "minigolf"});
  const Course course = course_at(complete_theta(*simulator, {}).transpose());
  BallWorld world(config, course, motion, kStep, kFarAway);
  const Eigen::Vector3d position(place.x(), place.y(), course.ball_radius);
  const Eigen::Vector3d velocity(0.0, 0.01, 0.0), spin(-0.01 / course.ball_radius, 0.0, 0.0);
  for (auto _ : state) {
    world.set_ball(position, velocity, spin);
    world.step(kSteps - 1);
  }
}
BENCHMARK_CAPTURE(step, rolled, Rolling::exact, kFarAway)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step, coarse, Rolling::engine, kFarAway)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step, fine_at_the_bound, Rolling::exact, Eigen::Vector2d(0.85, 1.6605))
    ->Unit(benchmark::kMicrosecond);

void club_motion(benchmark::State& state) {
  const MinigolfConfig config;
  for (auto _ : state) benchmark::DoNotOptimize(strike_motion(config));
}
BENCHMARK(club_motion)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace npdr::sim
