// Training steps/s and posterior samples/s of the networks of tables A3 to A5. Steps and bm_sgemm
// are counted on one thread and on two, each with a network of its own, as an ensemble's are
// trained. GFLOP/s counts the multiplications and additions of the matrix products of a step
// (forward and backward), of whole matrices, also where masked parts are left out; bm_sgemm is the
// same machine's rate at n = 1024.
#include <benchmark/benchmark.h>

#include "core/flush_subnormals.h"
#include "core/random.h"
#include "inference/algorithms/posterior_estimation.h"
#include "inference/direct_posterior.h"
#include "inference/training/adam.h"

namespace npdr::inference {
namespace {

struct Network {
  const char* name;
  Index dimension, x_features;
  TrainedEmbeddingConfig embedding;
  EstimatorConfig estimator;
};

EstimatorConfig maf(Index transforms, Index hidden) {
  EstimatorConfig config;
  config.kind = EstimatorKind::maf;
  config.num_transforms = transforms;
  config.hidden_features = hidden;
  return config;
}

EstimatorConfig splines() {
  EstimatorConfig config;
  config.kind = EstimatorKind::nsf;
  return config;
}

EstimatorConfig mixture(Index components) {
  EstimatorConfig config;
  config.kind = EstimatorKind::mdn;
  config.num_components = components;
  return config;
}

const Network kTableA3{"table A3, MAF", 2, 20, {}, maf(2, 20)};
const Network kTableA4{"table A4, MAF", 10, 1600, {128}, maf(10, 100)};
const Network kTableA5{"table A5, MAF", 9, 1000, {256}, maf(5, 50)};
const Network kSplines{"five transforms of splines", 5, 8, {}, splines()};
const Network kMixture{"mixture of 10", 9, 25, {}, mixture(10)};

class RandomRows : public FeatureSource {
 public:
  RandomRows(Index rows, Index features) : x_(rows, features) {
    Stream({1, "bench", 0, 0, 0}).fill_normal({x_.data(), static_cast<std::size_t>(x_.size())});
  }
  Index num_rows() const override { return x_.rows(); }
  Index num_features() const override { return x_.cols(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t, RowMatrixF& x) const override {
    x.resize(static_cast<Index>(rows.size()), x_.cols());
    for (std::size_t i = 0; i < rows.size(); ++i) x.row(static_cast<Index>(i)) = x_.row(rows[i]);
  }

 private:
  RowMatrixF x_;
};

// Multiply-adds of one step: forward, and twice that backward; the first layer on data needs no
// gradient of its input.
double flops_per_step(const Network& n, double batch, double atoms) {
  const auto d = static_cast<double>(n.dimension);
  const auto h = static_cast<double>(n.estimator.hidden_features);
  const auto f = static_cast<double>(n.x_features);
  const auto e = static_cast<double>(n.embedding.features);
  const double context = e > 0 ? e : f;
  const double linear = e > 0 ? 2.0 * batch * f * e * 2.0 : 0.0;
  const double context_passes = e > 0 ? 3.0 : 2.0;
  if (n.estimator.kind == EstimatorKind::mdn) {
    const double heads =
        static_cast<double>(n.estimator.num_components) * (1.0 + d + d * (d + 1.0) / 2.0);
    return linear + 2.0 * batch * (context * h * context_passes + (h * h + h * heads) * 3.0);
  }
  const auto k = static_cast<double>(n.estimator.num_transforms);
  const bool is_spline = n.estimator.kind == EstimatorKind::nsf;
  const double outputs = is_spline ? 3.0 * static_cast<double>(n.estimator.num_bins) + 1.0 : 2.0;
  return linear + 2.0 * batch * context * k * h * context_passes +
         2.0 * batch * atoms * k * (d * h + h * h + h * outputs * d) * 3.0;
}

DirectPosterior untrained(const Network& n) {
  std::vector<Marginal> marginals;
  for (Index d = 0; d < n.dimension; ++d) {
    marginals.push_back({"theta_" + std::to_string(d), "1", Marginal::Kind::uniform, 0.0, 1.0});
  }
  NetworkParts parts{.prior = Prior(marginals),
                     .of_role = DirectParts{.embedding = n.embedding},
                     .estimator = n.estimator,
                     .structure_seed = 1,
                     .transform = {VectorF::Zero(n.x_features), VectorF::Ones(n.x_features), {}},
                     .parameters = {},
                     .x_o = VectorF::Zero(n.x_features)};
  parts.parameters = make_network(n.estimator, n.x_features, n.embedding, n.dimension, 1)
                         .initial_parameters({1, "initial", 0, 0, 0});
  return DirectPosterior(parts);
}

// What a thread does once per iteration, of all threads together: iterations are those of all, and
// the library adds up what each of them has counted.
benchmark::Counter per_second(double value) {
  using benchmark::Counter;
  const auto of_all = Counter::kIsIterationInvariantRate | Counter::kAvgThreads;
  return Counter(value, static_cast<Counter::Flags>(of_all));
}

void each_thread_its_own(benchmark::internal::Benchmark* benchmark) {
  benchmark->ThreadRange(1, 2)->UseRealTime();
}

void bm_training_step(benchmark::State& state, const Network& n, std::uint32_t round,
                      Loss loss = Loss::atomic) {
  const Index rows = 1000, batch_size = 50;
  const RandomRows x(rows, n.x_features);
  const EmbeddedEstimator<float> network =
      make_network(n.estimator, n.x_features, n.embedding, n.dimension, 1);
  const FeatureTransform transform{VectorF::Zero(n.x_features), VectorF::Ones(n.x_features), {}};
  TrainingData data{&x,
                    RowMatrixF::Random(rows, n.dimension),
                    std::vector<std::uint32_t>(static_cast<std::size_t>(rows), round),
                    {}};
  const AlgorithmConfig algorithm{.loss = loss};
  if (loss == Loss::analytic) data.proposals = {proposal_mixture(untrained(n))};
  NpeC objective(algorithm, network, transform, data, {1, "train", round, 0, 0});
  Parameters<float> parameters = network.initial_parameters({1, "initial", 0, 0, 0});
  Parameters<float> gradient = Parameters<float>::Zero(parameters.size());
  Adam adam(parameters.size(), 3e-4);
  const auto order = Stream({1, "bench", 0, 1, 0}).permutation(static_cast<std::uint32_t>(rows));
  std::uint64_t step = 0;
  const FlushSubnormals flush;  // as training does
  for (auto _ : state) {
    const std::size_t begin = (step * static_cast<std::size_t>(batch_size)) % order.size();
    const Batch batch{std::span(order).subspan(begin, static_cast<std::size_t>(batch_size)), 1,
                      step++};
    objective.loss(parameters, batch, &gradient);
    adam.step(gradient, clip_scale(gradient, 5.0), parameters);
  }
  const double atoms = round > 1 && loss == Loss::atomic ? 10.0 : 1.0;
  state.counters["steps/s"] = per_second(1.0);
  state.counters["GFLOP/s"] =
      per_second(flops_per_step(n, static_cast<double>(batch_size), atoms) * 1e-9);
}
BENCHMARK_CAPTURE(bm_training_step, table_a3_maf_likelihood, kTableA3, 1u)
    ->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, table_a3_maf_atomic, kTableA3, 2u)->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, table_a4_maf_likelihood, kTableA4, 1u)
    ->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, table_a4_maf_atomic, kTableA4, 2u)->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, table_a5_maf_likelihood, kTableA5, 1u)
    ->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, table_a5_maf_atomic, kTableA5, 2u)->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, splines_likelihood, kSplines, 1u)->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, splines_atomic, kSplines, 2u)->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, mixture_likelihood, kMixture, 1u)->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, mixture_atomic, kMixture, 2u)->Apply(each_thread_its_own);
BENCHMARK_CAPTURE(bm_training_step, mixture_analytic, kMixture, 2u, Loss::analytic)
    ->Apply(each_thread_its_own);

void bm_sample(benchmark::State& state, const Network& n) {
  const DirectPosterior posterior = untrained(n);
  constexpr Index count = 10'000;
  for (auto _ : state) benchmark::DoNotOptimize(posterior.sample(count, {1, "bench", 0, 0, 0}));
  state.counters["samples/s"] = per_second(static_cast<double>(count));
}
BENCHMARK_CAPTURE(bm_sample, table_a3_maf, kTableA3)->UseRealTime();
BENCHMARK_CAPTURE(bm_sample, table_a5_maf, kTableA5)->UseRealTime();
BENCHMARK_CAPTURE(bm_sample, mixture, kMixture)->UseRealTime();

void bm_log_prob(benchmark::State& state, const Network& n) {
  const DirectPosterior posterior = untrained(n);
  constexpr Index count = 10'000;
  const RowMatrix theta = posterior.sample(count, {1, "bench", 0, 0, 0});
  for (auto _ : state) benchmark::DoNotOptimize(posterior.log_prob(theta));
  state.counters["densities/s"] = per_second(static_cast<double>(count));
}
BENCHMARK_CAPTURE(bm_log_prob, table_a3_maf, kTableA3)->UseRealTime();
BENCHMARK_CAPTURE(bm_log_prob, table_a5_maf, kTableA5)->UseRealTime();
BENCHMARK_CAPTURE(bm_log_prob, mixture, kMixture)->UseRealTime();

void bm_sgemm(benchmark::State& state) {
  constexpr Index n = 1024;
  const RowMatrixF a = RowMatrixF::Random(n, n), b = RowMatrixF::Random(n, n);
  RowMatrixF c(n, n);
  for (auto _ : state) {
    c.noalias() = a * b;
    benchmark::DoNotOptimize(c.data());
  }
  state.counters["GFLOP/s"] = per_second(2.0 * n * n * n * 1e-9);
}
BENCHMARK(bm_sgemm)->Apply(each_thread_its_own);

}  // namespace
}  // namespace npdr::inference
