#include "inference/pooled_posterior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "core/constants.h"
#include "core/error.h"
#include "inference/algorithms/pool_powers.h"
#include "inference/ensemble.h"
#include "inference/estimators/gaussian_mixture.h"
#include "inference/matrix_features.h"
#include "tests/inference/linear_gaussian_check.h"

namespace npdr::inference {
namespace {

// Untrained networks of one parameter and two features, disturbed: any density will do.
Parameters<float> some_weights(const NetworkParts& parts, double strength) {
  const auto network = make_network(parts);
  Parameters<float> weights = network.initial_parameters({1, "weights", 0, 0, 0});
  Stream stream({1, "disturbance", 0, 0, 0});
  for (float& weight : weights) {
    const double disturbance = strength * stream.normal();
    if (weight != 0.0f) weight += static_cast<float>(disturbance);
  }
  return weights;
}

std::optional<PooledLikelihood>& likelihood_of(NetworkParts& parts) {
  return std::get<DirectParts>(parts.of_role).likelihood;
}

NetworkParts some_pool(PoolPowers powers, double likelihood_strength = 0.2) {
  NetworkParts parts{
      .prior = Prior({{"a", "1", Marginal::Kind::uniform, -1.0, 3.0}}),
      .estimator = {.kind = EstimatorKind::maf, .num_transforms = 2, .hidden_features = 10},
      .structure_seed = 5,
      .transform = {VectorF::Zero(2), VectorF::Ones(2), {}},
      .parameters = {},
      .x_o = VectorF::Ones(2)};
  parts.parameters = some_weights(parts, 0.2);
  auto& likelihood = likelihood_of(parts);
  likelihood = {.estimator = parts.estimator, .transform = parts.transform, .powers = powers};
  likelihood->parameters = some_weights(likelihood_parts(parts), likelihood_strength);
  return parts;
}

constexpr Index kCells = 4000;
constexpr double kCell = 4.0 / kCells;

// Centers of cells of the prior's range.
RowMatrix grid() { return Vector::LinSpaced(kCells, -1.0 + 0.5 * kCell, 3.0 - 0.5 * kCell); }

const StreamId kPoolId{1, "posterior", 0, 0, 0};

TEST(PooledPosterior, DensityIsThePoolOfBothAndIntegratesToOne) {
  for (const PoolPowers powers :
       {PoolPowers{0.7, 0.3}, PoolPowers{0.0, 1.0}, PoolPowers{0.6, 0.9}}) {
    const NetworkParts parts = some_pool(powers);
    const PooledPosterior pool(parts);
    EXPECT_EQ(pool.powers(), powers);
    // Z is known to 0.02 nats: four standard errors (false-alarm rate 6e-5).
    EXPECT_NEAR(pool.log_prob(grid()).array().exp().sum() * kCell, 1.0, 0.08);
    const Vector prior = parts.prior.log_prob(grid());
    const Vector q = make_posterior(posterior_parts(parts))->log_prob(grid()) - prior;
    const Vector l = make_posterior(likelihood_parts(parts))->relative_log_prob(grid()) - prior;
    const Vector difference =
        pool.log_prob(grid()) - (prior + powers.posterior * q + powers.likelihood * l);
    EXPECT_LT((difference.array() - difference(0)).abs().maxCoeff(), 1e-9);
    EXPECT_EQ(pool.log_prob(RowMatrix::Constant(1, 1, 3.5))(0), -kInfinity);
  }
}

// Both are means of the same weights over draws of q: one to 0.02 nats, one over the candidates.
TEST(PooledPosterior, DrawingEstimatesItsNormalizer) {
  const PooledPosterior pool(some_pool({0.6, 0.9}));
  const Samples samples = pool.draw(1300, kPoolId);
  ASSERT_TRUE(samples.report);
  const auto candidates = static_cast<double>(samples.report->num_evaluations);
  const double efficiency = samples.report->ess(0) / candidates;
  // Four standard errors of their difference (false-alarm rate 6e-5).
  const double error = std::hypot(std::sqrt((1.0 / efficiency - 1.0) / candidates), 0.02);
  EXPECT_NEAR(samples.report->log_normalizer, pool.log_normalizer(), 4.0 * error);
  EXPECT_NE(pool.log_normalizer(), 0.0);
}

TEST(PooledPosterior, SamplesHaveTheQuantilesOfTheDensity) {
  const PooledPosterior pool(some_pool({0.4, 0.9}));
  const Samples samples = pool.draw(5000, kPoolId);
  const Vector density = pool.log_prob(grid()).array().exp();
  for (const double at : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    const Index below = static_cast<Index>((at + 1.0) / kCell);
    const double expected = density.head(below).sum() * kCell;
    const double found = (samples.theta.col(0).array() < at).cast<double>().mean();
    // Six standard errors of 5000 samples, of which resampling leaves most different.
    EXPECT_NEAR(found, expected, 6.0 * 0.5 / std::sqrt(5000.0)) << at;
  }
  ASSERT_TRUE(samples.report);
  EXPECT_GT(samples.report->ess(0), 10'000.0);  // twice the samples
}

TEST(PooledPosterior, DrawsThatRepeatEachOtherMoveToTheirDensity) {
  // The likelihood says nothing, so that the pool is the uniform prior, and q is N(0, 0.30^2 I)
  // over u: few of its draws have nearly all of the weight. The scale is the first of the last 16.
  NetworkParts parts = some_pool({0.0, 1.0});
  likelihood_of(parts)->parameters.setZero();
  parts.parameters.setZero();
  parts.parameters.tail(16)(0) = 2.8f;
  constexpr Index n = 2000;
  const Samples samples = PooledPosterior(parts).draw(n, kPoolId);
  ASSERT_TRUE(samples.report);
  ASSERT_LT(samples.report->ess(0), 2.0 * n);
  const std::set<double> different(samples.theta.data(), samples.theta.data() + n);
  EXPECT_EQ(static_cast<Index>(different.size()), n);
  for (const double at : {-0.8, 0.0, 1.0, 2.0, 2.8}) {
    const double expected = (at + 1.0) / 4.0;
    const double found = (samples.theta.col(0).array() < at).cast<double>().mean();
    // Four standard errors of half as many independent samples (false-alarm rate 3e-4).
    EXPECT_NEAR(found, expected, 4.0 * std::sqrt(expected * (1.0 - expected) / (n / 2))) << at;
  }
}

TEST(PooledPosterior, ASampleDependsOnItsRowAlone) {
  const PooledPosterior pool(some_pool({0.4, 0.9}));
  const RowMatrix many = pool.sample(1300, kPoolId);
  EXPECT_EQ(pool.sample(7, kPoolId), many.topRows(7));
  EXPECT_EQ(pool.sample(900, kPoolId), many.topRows(900));
  const std::set<double> different(many.data(), many.data() + many.size());
  EXPECT_GT(different.size(), 1100u);
}

// As for neighboring simulations of calibration, each of which takes several batches of candidates.
TEST(PooledPosterior, CandidatesOfAnotherEpochAreOthers) {
  const PooledPosterior pool(some_pool({0.4, 0.9}, 0.5));
  std::set<double> different;
  constexpr Index n = 1000;
  for (const std::uint64_t epoch : {0u, 1u}) {
    StreamId id = kPoolId;
    id.epoch = epoch;
    const Samples samples = pool.draw(n, id);
    ASSERT_GE(samples.report->num_evaluations, 2 * 4000);
    std::set<double> own(samples.theta.data(), samples.theta.data() + n);
    const std::size_t both = different.size() + own.size();
    different.merge(own);
    EXPECT_GE(different.size() + 5, both) << epoch;  // floats may agree
  }
}

TEST(PooledPosterior, WithoutALikelihoodIsThePosteriorItself) {
  const NetworkParts parts = some_pool({1.0, 0.0});
  const PooledPosterior pool(parts);
  const auto alone = make_posterior(posterior_parts(parts));
  EXPECT_EQ(pool.sample(700, kPoolId), alone->sample(700, kPoolId));
  EXPECT_EQ(pool.log_prob(grid()), alone->log_prob(grid()));
}

TEST(PooledPosterior, TakesLessOfALikelihoodThatContradictsIt) {
  // A likelihood far from anything that the posterior's draws know.
  const PooledPosterior pool(some_pool({0.5, 1.0}, 4.0));
  EXPECT_LT(pool.powers().likelihood, 1.0);
  EXPECT_GE(pool.powers().likelihood, 0.0);
  EXPECT_DOUBLE_EQ(pool.powers().posterior, 1.0 - 0.5 * pool.powers().likelihood);
  EXPECT_TRUE(pool.log_prob(grid()).array().isFinite().all());
  EXPECT_GE(pool.draw(500, kPoolId).report->ess(0), 500.0);
}

TEST(PooledPosterior, WhatANetworkDoesntKnowWeighsNothing) {
  const PoolEvidence evidence{Vector{{1.0, kNaN, -kInfinity, 1.0}}, Vector{{2.0, 3.0, 3.0, kNaN}}};
  for (const PoolPowers powers :
       {PoolPowers{0.5, 0.5}, PoolPowers{1.0, 0.5}, PoolPowers{1.5, 0.2}}) {
    const Vector weights = evidence.log_weights(powers);
    EXPECT_DOUBLE_EQ(weights(0), powers.posterior - 1.0 + 2.0 * powers.likelihood);
    EXPECT_TRUE(weights.allFinite());
    EXPECT_LT(weights.tail(3).maxCoeff(), -1e90);
  }
}

TEST(PooledPosterior, RefusesWeightsOfAnotherNetwork) {
  NetworkParts parts = some_pool({});
  likelihood_of(parts)->parameters.conservativeResize(3);
  EXPECT_THROW(PooledPosterior{parts}, ShapeError);
}

// Of a linear-Gaussian task, trained once.
class PoolPowersOf : public ::testing::Test {
 protected:
  PoolPowersOf() : prior_(task_.prior()) {
    config_ = small_config(Algorithm::npe_nle, EstimatorKind::maf, 1, 2000);
    config_.estimator.num_networks = 2;
    data_.prior = &prior_;
    data_.theta = sample_prior(prior_, 2000, 1);
    data_.round.assign(2000, 1);
    data_.x_o = VectorF::Ones(2);
    x_ = simulate(task_.simulator(), data_.theta, 1, 1);
    source_.emplace(x_);
    data_.x = &*source_;
    static const NetworkParts trained = [&] {
      std::vector<TrainingState> states;
      return estimate_posterior(config_, data_, kTraining, states, never_stop)->parts();
    }();
    parts_ = trained;
  }

  // By the rows that have trained nothing.
  PoolPowers powers() const {
    const Index count = num_judging_rows(data_.theta.rows());
    std::vector<std::uint32_t> rows(static_cast<std::size_t>(count));
    std::iota(rows.begin(), rows.end(), static_cast<std::uint32_t>(data_.theta.rows() - count));
    return pool_powers(*parts_, data_, rows, kTraining);
  }

  static constexpr StreamId kTraining{1, "training", 1, 0, 0};
  const LinearGaussian task_{2};
  const Prior prior_;
  PosteriorEstimationConfig config_;
  RoundData data_;
  RowMatrixF x_;
  std::optional<MatrixFeatures> source_;
  std::optional<NetworkParts> parts_;
};

TEST_F(PoolPowersOf, CalibratedNetworksAddUpToOne) {
  EXPECT_EQ(powers(), parts_->pooled_likelihood()->powers);
  // 100 simulations, each of information 1 about the sum: a standard error of 0.1. Means of
  // networks are a little too wide.
  EXPECT_NEAR(powers().posterior + powers().likelihood, 1.1, 0.3);
}

// 20 simulations have a standard error of 0.2 of the sum: half of the best sums are above 1, a
// seventh by more than that. Seven of twenty are so with a probability of 0.02.
TEST_F(PoolPowersOf, PosteriorsArentSharpenedByFewSimulations) {
  Index sharpened = 0;
  for (std::uint64_t seed = 2; seed < 22; ++seed) {
    data_.theta = sample_prior(prior_, 400, seed);
    x_ = simulate(task_.simulator(), data_.theta, 1, seed);
    source_.emplace(x_);
    data_.x = &*source_;
    const PoolPowers found = powers();
    sharpened += found.posterior + found.likelihood > 1.01 ? 1 : 0;
  }
  EXPECT_LE(sharpened, 6);
}

// Means of four simulations have half the noise that the networks have learned: their likelihood to
// the fourth power would be right, and the largest sum is 2.
TEST_F(PoolPowersOf, SharpenWhatIsTooWide) {
  for (std::uint64_t round = 2; round < 5; ++round) {
    x_ += simulate(task_.simulator(), data_.theta, 1, round);
  }
  x_ /= 4.0f;
  source_.emplace(x_);
  EXPECT_GE(powers().posterior + powers().likelihood, 1.7);
}

TEST_F(PoolPowersOf, NetworksThatPredictNothingHaveNone) {
  likelihood_of(*parts_)->parameters *= -1.0f;
  EXPECT_LE(powers().likelihood, 0.1);
  EXPECT_NEAR(powers().posterior, 1.0, 0.3);
}

TEST_F(PoolPowersOf, NetworksThatAreWrongThroughoutHaveNone) {
  // Networks that were shown other parameters' x have nothing to say of these.
  data_.theta = sample_prior(prior_, 2000, 2);
  EXPECT_LE(powers().posterior + powers().likelihood, 0.3);
}

TEST(PoolPowers, JudgedByATwentiethOfTheSimulations) {
  EXPECT_EQ(num_judging_rows(19), 0);
  EXPECT_EQ(num_judging_rows(1000), 50);
  EXPECT_EQ(num_judging_rows(100'000), 300);
}

}  // namespace
}  // namespace npdr::inference
