// Simulation-based calibration of NPE-C's first round on the pendulum: prior, simulator, noise,
// embedding, density estimator and sampler together.
#include <gtest/gtest.h>

#include <iostream>
#include <numeric>

#include "inference/diagnostics/sbc.h"
#include "inference/embeddings/embedding.h"
#include "sim/observation_noise.h"
#include "sim/simulator.h"
#include "tests/inference/tasks.h"

namespace npdr {
namespace {

constexpr Index kNumTruths = 400;
constexpr Index kNumSamples = 99;
constexpr Index kNumBins = 10;

/// The pendulum study of table A3 with one rollout, noise of 15 % and the all-steps embedding.
struct PendulumTask {
  std::unique_ptr<sim::Simulator> simulator;
  Target target;
  std::unique_ptr<inference::Embedding> embedding;
  inference::Prior prior;
};

PendulumTask make_task() {
  sim::SimulatorConfig simulator_config;
  simulator_config.name = "pendulum";
  auto simulator = sim::make_simulator(simulator_config);
  Target target = simulator->behave(sim::complete_theta(*simulator, {}), 1, 1);
  inference::EmbeddingConfig embedding_config;
  embedding_config.kind = inference::EmbeddingKind::all_steps;
  embedding_config.downsample = 20;
  auto embedding = inference::make_embedding(embedding_config, target, 1);
  using Kind = inference::Marginal::Kind;
  return {std::move(simulator), std::move(target), std::move(embedding),
          inference::Prior({{"pole_mass", "kg", Kind::uniform, 0.3, 1.7},
                            {"pole_length", "m", Kind::uniform, 0.3, 1.7}})};
}

/// x of simulations at `theta`; every epoch sees other noise, as in a study.
class NoisyFeatures : public inference::FeatureSource {
 public:
  NoisyFeatures(const PendulumTask& task, const RowMatrix& theta, std::uint64_t seed)
      : embedding_(*task.embedding),
        amplitude_(sim::reference_amplitude(task.target)),
        seed_(seed) {
    RowMatrix full =
        sim::complete_theta(*task.simulator, {}).transpose().replicate(theta.rows(), 1);
    const sim::SimulatorInfo& info = task.simulator->info();
    full.col(sim::parameter_index(info, "pole_mass")) = theta.col(0);
    full.col(sim::parameter_index(info, "pole_length")) = theta.col(1);
    const sim::Trajectories trajectories = task.simulator->replay(task.target, full);
    picked_.resize(theta.rows(), embedding_.selection().num_values());
    for (Index i = 0; i < theta.rows(); ++i) {
      embedding_.selection().pick(trajectories.row(i), row_of(picked_, i));
    }
  }
  Index num_rows() const override { return picked_.rows(); }
  Index num_features() const override { return embedding_.num_features(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
              RowMatrixF& x) const override {
    x.resize(static_cast<Index>(rows.size()), num_features());
    RowMatrixF noisy(1, picked_.cols());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Stream stream({seed_, "noise", 1, rows[i], epoch});
      noisy = picked_.row(rows[i]);
      sim::add_observation_noise(row_of(noisy, 0), 0.15 * amplitude_, stream);
      embedding_.embed(row_of(noisy, 0), row_of(x, static_cast<Index>(i)));
    }
  }

 private:
  static std::span<float> row_of(RowMatrixF& matrix, Index i) {
    return {matrix.row(i).data(), static_cast<std::size_t>(matrix.cols())};
  }

  const inference::Embedding& embedding_;
  RowMatrix amplitude_;
  std::uint64_t seed_;
  RowMatrixF picked_;
};

std::unique_ptr<inference::NetworkPosterior> train(const PendulumTask& task,
                                                   inference::EstimatorKind estimator) {
  constexpr Index num_simulations = 5'000;
  inference::PosteriorEstimationConfig config;
  config.algorithm.num_simulations = num_simulations;
  config.estimator.kind = estimator;
  config.estimator.hidden_features = 50;
  config.estimator.num_components = 5;
  config.training.batch_size = 100;
  config.training.learning_rate = 1e-3;
  inference::RoundData data;
  data.prior = &task.prior;
  data.theta = inference::sample_prior(task.prior, num_simulations, 1);
  const NoisyFeatures x(task, data.theta, 1);
  data.x = &x;
  data.round.assign(num_simulations, 1);
  data.x_o = inference::observed_features(*task.embedding, task.target, 1);
  std::vector<inference::TrainingState> states;
  return inference::estimate_posterior(config, data, {1, "train", 1, 0, 0}, states,
                                       inference::never_stop);
}

// Ranks of each parameter over fresh truths from the prior.
std::vector<std::vector<Index>> rank_truths(const PendulumTask& task,
                                            const inference::NetworkPosterior& posterior) {
  const RowMatrix truths = inference::sample_prior(task.prior, kNumTruths, 2);
  std::vector<std::uint32_t> all_rows(kNumTruths);
  std::iota(all_rows.begin(), all_rows.end(), 0u);
  RowMatrixF x;
  NoisyFeatures(task, truths, 2).gather(all_rows, 0, x);
  std::vector<std::vector<Index>> all(2);
  for (Index i = 0; i < kNumTruths; ++i) {
    const RowMatrix samples =
        posterior.given(x.row(i).transpose())
            ->sample(kNumSamples, {2, "posterior", static_cast<std::uint64_t>(i), 0, 0});
    const std::vector<Index> ranks = inference::ranks(samples, truths.row(i).transpose());
    for (std::size_t d = 0; d < all.size(); ++d) all[d].push_back(ranks[d]);
  }
  return all;
}

// One of the four p-values falls below 1e-4 by chance once in 2500 trainings: seeds are fixed, but
// other instruction sets round in other ways, and so train other networks. A posterior that is 25 %
// too narrow is below it with 400 truths (sbc_test.cpp).
class PendulumCalibration : public testing::TestWithParam<inference::EstimatorKind> {};

TEST_P(PendulumCalibration, RanksOfTheTruthAreUniform) {
  const PendulumTask task = make_task();
  const auto ranks = rank_truths(task, *train(task, GetParam()));
  for (std::size_t d = 0; d < ranks.size(); ++d) {
    const inference::ChiSquare test = inference::test_chi_square(
        inference::spread_ranks(ranks[d], kNumSamples, {2, "spread", d, 0, 0}), kNumBins);
    const std::string& name = task.prior.marginals()[d].name;
    std::cout << name_of(GetParam()) << ", " << name << ": " << kNumTruths << " truths, ranks";
    for (const Index count : test.counts) std::cout << ' ' << count;
    std::cout << ", chi^2 = " << test.statistic << ", p = " << test.p_value << '\n';
    EXPECT_GT(test.p_value, 1e-4) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Estimators, PendulumCalibration,
                         testing::Values(inference::EstimatorKind::maf,
                                         inference::EstimatorKind::mdn),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace npdr
