/// Rollouts per second and thread of the ODE simulators.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <string>

#include "core/random.h"
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
void replay(benchmark::State& state, const std::string& name, const std::string& integrator) {
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

BENCHMARK_CAPTURE(replay, furuta_erk4, "furuta", "erk4")
    ->ArgNames({"rows", "store_every"})
    ->ArgsProduct({{1, 8, 128, 1024}, {1, 25}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, furuta_cvode, "furuta", "cvode")
    ->ArgNames({"rows", "store_every"})
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, pendulum_erk4, "pendulum", "erk4")
    ->ArgNames({"rows", "store_every"})
    ->ArgsProduct({{1, 8, 128, 1024}, {1, 25}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(replay, pendulum_cvode, "pendulum", "cvode")
    ->ArgNames({"rows", "store_every"})
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace npdr::sim
