// Dynamic time warping on the size of the Furuta recordings: 1250 steps of 4 channels.
#include <benchmark/benchmark.h>

#include "analysis/dtw.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

constexpr Index kSteps = 1250;

std::vector<double> normals(Index count) {
  Stream stream({1, "bench_analysis"});
  std::vector<double> values(static_cast<std::size_t>(count));
  for (double& v : values) v = stream.normal();
  return values;
}

void report_cells(benchmark::State& state, Index series) {
  const double cells = static_cast<double>(state.iterations() * series * kSteps * kSteps);
  state.counters["cells"] = benchmark::Counter(cells, benchmark::Counter::kIsRate);
  state.counters["s_per_cell"] =
      benchmark::Counter(cells, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void BM_DtwScalar(benchmark::State& state) {
  const Index channels = state.range(0);
  const auto values = normals(2 * kSteps * channels);
  const Eigen::Map<const RowMatrix> recorded(values.data(), kSteps, channels);
  const Eigen::Map<const RowMatrix> simulated(values.data() + recorded.size(), kSteps, channels);
  for (auto _ : state) benchmark::DoNotOptimize(dtw(recorded, simulated));
  report_cells(state, 1);
}
BENCHMARK(BM_DtwScalar)->Arg(2)->Arg(4)->ArgName("channels")->Unit(benchmark::kMillisecond);

void BM_DtwBatch(benchmark::State& state) {
  const Index channels = state.range(0);
  const Index series = state.range(1);
  const auto recorded = normals(kSteps * channels);
  const auto simulated = normals(series * kSteps * channels);
  const Eigen::Map<const RowMatrix> view(recorded.data(), kSteps, channels);
  for (auto _ : state) benchmark::DoNotOptimize(dtw_batch(view, simulated, series));
  report_cells(state, series);
}
BENCHMARK(BM_DtwBatch)
    ->ArgsProduct({{2, 4, 9}, {8, 64}})
    ->ArgNames({"channels", "series"})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace npdr::analysis
