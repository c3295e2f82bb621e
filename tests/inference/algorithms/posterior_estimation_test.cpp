#include "inference/algorithms/posterior_estimation.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "inference/algorithms/round_task.h"
#include "inference/matrix_features.h"
#include "inference/surrogate_posterior.h"
#include "inference/truncated_prior.h"
#include "inference/weighted_population.h"
#include "tests/inference/linear_gaussian_check.h"
#include "tests/message_of.h"

namespace npdr::inference {
namespace {

TEST(NpeA, FindsTheLinearGaussianPosteriorOverRounds) {
  expect_linear_gaussian(small_config(Algorithm::npe_a, EstimatorKind::mdn, 1, 8000));
  // The estimate of the second round is twice as precise as the posterior, and what is left of its
  // precision after the division has twice its relative error.
  expect_linear_gaussian(small_config(Algorithm::npe_a, EstimatorKind::mdn, 2, 4000), 2.0);
}

TEST(NpeA, NeedsSimulationsOfItsOwnRound) {
  const Prior prior({{"a", "1", Marginal::Kind::uniform, 0.0, 1.0}});
  const RowMatrixF x(0, 2);
  const MatrixFeatures none(x);
  const RoundData data{&prior, &none, RowMatrix(0, 1), {}, VectorF::Zero(2), {}};
  std::vector<TrainingState> states;
  EXPECT_TRUE(says(message_of<InputError>([&] {
                     estimate_posterior(small_config(Algorithm::npe_a, EstimatorKind::mdn, 1, 10),
                                        data, {1, "training", 1, 0, 0}, states, never_stop);
                   }),
                   {"training: 0 training and 0 validation rows"}));
}

// Rounds are counted anew for a posterior that begins again, whatever its random numbers are.
TEST(NpeA, GrowsInTheLastOfItsRoundsAlone) {
  const LinearGaussian task(1);
  const Prior prior = task.prior();
  PosteriorEstimationConfig c = small_config(Algorithm::npe_a, EstimatorKind::mdn, 2, 100);
  c.training.max_epochs = 1;
  const RowMatrix theta = sample_prior(prior, 100, 1);
  const RowMatrixF x = simulate(task.simulator(), theta, 1, 1);
  const MatrixFeatures source(x);
  const RoundData data{.prior = &prior,
                       .x = &source,
                       .theta = theta,
                       .round = std::vector<std::uint32_t>(100, 1),
                       .x_o = VectorF::Ones(1),
                       .posteriors = {}};
  std::vector<TrainingState> states;
  const StreamId id{1, "training", (std::uint64_t{1} << 32) + 1, 0, 0};
  const auto first = estimate_posterior(c, data, id, states, never_stop);
  EXPECT_EQ(first->parts().estimator.num_components, 1);
  c.algorithm.num_rounds = 1;
  std::vector<TrainingState> last_states;
  const auto last = estimate_posterior(c, data, id, last_states, never_stop);
  EXPECT_EQ(last->parts().estimator.num_components, 4);
}

// Half of the first round's rows have failed.
TEST(NpeB, WeighsByTheMixtureThatRowsWereDrawnFrom) {
  const LinearGaussian task(1);
  const Prior prior = task.prior();
  PosteriorEstimationConfig c = small_config(Algorithm::npe_b, EstimatorKind::maf, 1, 100);
  c.training.max_epochs = 1;
  const std::shared_ptr<const NetworkPosterior> posterior =
      infer(c, prior, task.simulator(), VectorF::Ones(1), 1);
  RoundData data{.prior = &prior,
                 .x = nullptr,
                 .theta = sample_prior(prior, 150, 1),
                 .round = std::vector<std::uint32_t>(150, 2),
                 .x_o = VectorF::Ones(1),
                 .posteriors = {posterior},
                 .num_simulated = {100, 100}};
  std::fill_n(data.round.begin(), 50, 1u);
  const VectorF weights = learned_rows(c, data, false).weights;
  const Vector ratio = (posterior->log_prob(data.theta) - prior.log_prob(data.theta)).array().exp();
  for (Index i = 0; i < 150; ++i) {
    EXPECT_NEAR(weights(i) * (0.5 + 0.5 * ratio(i)), 1.0, 1e-5) << i;
  }
}

TEST(NpeB, FindsTheLinearGaussianPosteriorOverRounds) {
  expect_linear_gaussian(small_config(Algorithm::npe_b, EstimatorKind::maf, 2, 2000));
}

TEST(NpeC, SplinesFindTheLinearGaussianPosterior) {
  expect_linear_gaussian(small_config(Algorithm::npe_c, EstimatorKind::nsf, 1, 4000));
}

TEST(NpeNle, FindsTheLinearGaussianPosterior) {
  expect_linear_gaussian(small_config(Algorithm::npe_nle, EstimatorKind::nsf, 1, 4000));
}

TEST(NpeNle, FindsTheLinearGaussianPosteriorOverRounds) {
  expect_linear_gaussian(small_config(Algorithm::npe_nle, EstimatorKind::maf, 3, 1500));
}

// Regions of two rounds that overlap in part. What is learned of the last one must be like the
// prior's draws there.
TEST(NpeNle, WeighsRowsAsDrawsOfThePrior) {
  constexpr Index n = 4000;
  const LinearGaussian task(2);
  const Prior prior = task.prior();
  const auto posterior_at = [&](double x) -> std::shared_ptr<const NetworkPosterior> {
    PosteriorEstimationConfig c = small_config(Algorithm::npe_c, EstimatorKind::maf, 1, 500);
    c.training.max_epochs = 60;
    return infer(c, prior, task.simulator(), VectorF::Constant(2, static_cast<float>(x)), 1);
  };
  RoundData data{.prior = &prior,
                 .x = nullptr,
                 .theta = sample_prior(prior, n, 1),
                 .round = std::vector<std::uint32_t>(n, 1),
                 .x_o = VectorF::Zero(2),
                 .posteriors = {posterior_at(1.5), posterior_at(0.0)}};
  for (const auto& [r, count] : {std::pair{2u, 5 * n}, {3u, n}}) {
    data.theta.conservativeResize(data.theta.rows() + count, Eigen::NoChange);
    data.theta.bottomRows(count) =
        TruncatedPrior(*data.posteriors[r - 2]).sample(count, {1, "proposal", r, 0, 0});
    data.round.resize(static_cast<std::size_t>(data.theta.rows()), r);
  }
  const LearnedRows learned =
      learned_rows(small_config(Algorithm::npe_nle, EstimatorKind::maf, 3, n), data, true);
  EXPECT_EQ(learned.judging.size(), 300u);
  const RowMatrix rows = data.theta(learned.rows, Eigen::all);
  const Vector weights = learned.weights(learned.rows).cast<double>();
  EXPECT_NEAR(weights.mean(), 1.0, 1e-6);
  const RowMatrix draws = sample_prior(prior, 400'000, 2);
  const RowMatrix expected =
      draws(TruncatedPrior(*data.posteriors[1]).rows_within(draws), Eigen::all);
  ASSERT_GT(expected.rows(), 10'000);
  for (Index d = 0; d < 2; ++d) {
    const double mean = expected.col(d).mean();
    const double variance = (expected.col(d).array() - mean).square().mean();
    const double count = 1.0 / effective_size(weights) + 1.0 / static_cast<double>(expected.rows());
    // Five standard errors (false-alarm rate 6e-7 each). Masses that are 3 % too large move weights
    // by as much, and means by less than that of a deviation.
    const double error = 5.0 * std::sqrt(variance * count) + 0.03 * std::sqrt(variance);
    EXPECT_NEAR(weighted_mean(rows, weights)(d), mean, error) << d;
    EXPECT_GT(rows.col(d).mean() - mean, 2.0 * error) << "all the same, they'd be others";
  }
}

// Stopped after some epochs of one of the likelihood's networks.
void expect_same_bits_after_a_stop(const PosteriorEstimationConfig& c, const RoundData& data,
                                   const StreamId& id) {
  std::vector<TrainingState> all, states(4);
  const auto whole = estimate_posterior(c, data, id, all, never_stop);
  ASSERT_EQ(all.size(), 4u);
  const auto stopped = estimate_posterior(c, data, id, states, [&](Index k, const auto& state) {
    states[static_cast<std::size_t>(k)] = state;
    return k < 2 || state.epoch < 3;
  });
  EXPECT_EQ(stopped, nullptr);
  const auto resumed = estimate_posterior(c, data, id, states, never_stop);
  EXPECT_EQ(resumed->parts().parameters, whole->parts().parameters);
  EXPECT_EQ(resumed->parts().pooled_likelihood()->parameters,
            whole->parts().pooled_likelihood()->parameters);
  EXPECT_EQ(resumed->parts().pooled_likelihood()->powers,
            whole->parts().pooled_likelihood()->powers);
}

TEST(NpeNle, GoesOnFromStatesWithTheSameBits) {
  const LinearGaussian task(2);
  const Prior prior = task.prior();
  PosteriorEstimationConfig c = small_config(Algorithm::npe_nle, EstimatorKind::maf, 1, 200);
  c.estimator.num_networks = 2;
  c.training.max_epochs = 6;
  RoundData data{.prior = &prior,
                 .x = nullptr,
                 .theta = sample_prior(prior, 200, 1),
                 .round = std::vector<std::uint32_t>(200, 1),
                 .x_o = VectorF::Ones(2),
                 .posteriors = {}};
  RowMatrixF x = simulate(task.simulator(), data.theta, 1, 1);
  const MatrixFeatures source(x);
  data.x = &source;
  const StreamId first{1, "training", 1, 0, 0}, second{1, "training", 2, 0, 0};
  expect_same_bits_after_a_stop(c, data, first);

  // A second round, whose networks begin as those of a first one that has learned something.
  PosteriorEstimationConfig longer = c;
  longer.training.max_epochs = 60;
  std::vector<TrainingState> states;
  data.posteriors = {estimate_posterior(longer, data, first, states, never_stop)};
  data.theta.conservativeResize(400, Eigen::NoChange);
  data.theta.bottomRows(200) = propose(c, *data.posteriors.back(), 200, {1, "proposal", 2, 0, 0});
  data.round.resize(400, 2);
  x = simulate(task.simulator(), data.theta, 1, 1);
  const std::size_t num_learned = learned_rows(c, data, false).rows.size();
  EXPECT_GE(num_learned, 200u);
  EXPECT_LT(num_learned, 400u);
  expect_same_bits_after_a_stop(c, data, second);
}

TEST(Nle, FindsTheLinearGaussianPosterior) {
  expect_linear_gaussian(small_config(Algorithm::nle, EstimatorKind::maf, 1, 4000));
  expect_linear_gaussian(small_config(Algorithm::nle, EstimatorKind::maf, 2, 2000));
}

TEST(NreA, FindsTheLinearGaussianPosterior) {
  expect_linear_gaussian(small_config(Algorithm::nre_a, EstimatorKind::resnet, 1, 4000),
                         2.0);  // as NRE-B below
}

TEST(NreB, FindsTheLinearGaussianPosteriorOverRounds) {
  // A classifier learns the ratio of densities less accurately than a density.
  expect_linear_gaussian(small_config(Algorithm::nre_b, EstimatorKind::resnet, 1, 4000), 2.0);
  expect_linear_gaussian(small_config(Algorithm::nre_b, EstimatorKind::resnet, 2, 2000), 2.0);
}

TEST(Algorithms, SayWhichEstimatorsSuitThem) {
  EXPECT_EQ(message_of<InputError>([] { check_estimator(Algorithm::nre_b, {}); }),
            "density_estimator.kind = 'nsf', must be one of resnet with algorithm 'nre_b'");
  EXPECT_EQ(message_of<InputError>([] {
              check_estimator(Algorithm::npe_a, {.kind = EstimatorKind::mdn, .num_networks = 5});
            }),
            "density_estimator.num_networks = 5, must be 1 with algorithm 'npe_a'");
}

TEST(Algorithms, EveryOneIsFoundByItsNameAndByOlderSpellings) {
  for (const AlgorithmTraits& traits : enum_table(Algorithm{})) {
    EXPECT_EQ(value_named<Algorithm>(traits.name), traits.value) << traits.name;
    EXPECT_EQ(estimators_of(traits).empty(), traits.family != AlgorithmFamily::network)
        << traits.name;
  }
  EXPECT_EQ(value_named<Algorithm>("bayessim"), Algorithm::npe_a);
  EXPECT_EQ(value_named<Algorithm>("snle"), Algorithm::nle);
  EXPECT_EQ(value_named<Algorithm>("apt"), Algorithm::npe_c);
}

}  // namespace
}  // namespace npdr::inference
