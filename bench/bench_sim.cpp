/// Rollouts per second and thread of the ODE simulators: replay, and closed loop with a policy.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <string>

#include "core/random.h"
#include "sim/policy_task.h"
#include "sim/simulator.h"

namespace npdr::sim {
namespace {

// Parameters within 20 % of nominal.
RowMatrix random_thetas(const Simulator& simulator, Index count) {
  RowMatrix theta = complete_theta(simulator, {}).transpose().replicate(count, 1);
  Stream stream({1, "bench_sim", 0, 0, 0});
  for (double& value : theta.reshaped()) value *= 0.8 + 0.4 * stream.uniform();
  return theta;
}

// Arguments: rows, store_every.
void replay(benchmark::State& state, const std::string& name, Integrator integrator) {
  omp_set_num_threads(1);
  const auto simulator = make_simulator({.name = name,
                                         .segment_length = 200,
                                         .integrator = integrator,
                                         .store_every = state.range(1)});
  const Target target = simulator->behave(complete_theta(*simulator, {}), 5, 1);
  const RowMatrix theta = random_thetas(*simulator, state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(simulator->replay(target, theta));
  }
  const auto rollouts = static_cast<double>(theta.rows() * target.num_rollouts());
  using benchmark::Counter;
  state.counters["rollouts/s"] = Counter(rollouts, Counter::kIsIterationInvariantRate);
  state.counters["s/step"] = Counter(rollouts * static_cast<double>(target.num_steps()),
                                     Counter::kIsIterationInvariantRate | Counter::kInvert);
}

// Closed loop over 1250 steps; argument: rows. The initial policy keeps the limits nearly always,
// one that pushes the arm away ends all rollouts early.
void closed_loop(benchmark::State& state, Integrator integrator, double centering_gain) {
  omp_set_num_threads(1);
  const SimulatorConfig config{.name = "furuta", .integrator = integrator};
  const auto task = make_policy_task(config);
  const RowMatrix theta = random_thetas(*make_simulator(config), state.range(0));
  const RowMatrix start = task->initial_states(theta.rows(), {1, "bench_sim"});
  Vector policy = initial_policy(task->info());
  policy(2) = centering_gain;
  const RowMatrix policies = policy.transpose().replicate(theta.rows(), 1);
  for (auto _ : state) {
    benchmark::DoNotOptimize(task->run(theta, start, policies));
  }
  using benchmark::Counter;
  state.counters["rollouts/s"] =
      Counter(static_cast<double>(theta.rows()), Counter::kIsIterationInvariantRate);
}

BENCHMARK_CAPTURE(closed_loop, furuta_erk4, Integrator::erk4, 0.4)
    ->ArgName("rows")
    ->Arg(1)
    ->Arg(128)
    ->Arg(5200)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closed_loop, furuta_erk4_ends_early, Integrator::erk4, -50.0)
    ->ArgName("rows")
    ->Arg(5200)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closed_loop, furuta_cvode, Integrator::cvode, 0.4)
    ->ArgName("rows")
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, furuta_erk4, "furuta", Integrator::erk4)
    ->ArgNames({"rows", "store_every"})
    ->ArgsProduct({{1, 8, 128, 1024}, {1, 25}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, furuta_cvode, "furuta", Integrator::cvode)
    ->ArgNames({"rows", "store_every"})
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, pendulum_erk4, "pendulum", Integrator::erk4)
    ->ArgNames({"rows", "store_every"})
    ->ArgsProduct({{1, 8, 128, 1024}, {1, 25}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, pendulum_cvode, "pendulum", Integrator::cvode)
    ->ArgNames({"rows", "store_every"})
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace npdr::sim
