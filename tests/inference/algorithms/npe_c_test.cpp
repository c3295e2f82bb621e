#include "inference/algorithms/npe_c.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "core/error.h"
#include "tests/inference/gradient_check.h"
#include "tests/inference/tasks.h"

namespace npdr::inference {
namespace {

PosteriorEstimationConfig config(const std::string& estimator, const std::string& loss,
                                 Index rounds, Index simulations) {
  PosteriorEstimationConfig c;
  c.algorithm.num_rounds = rounds;
  c.algorithm.num_simulations = simulations;
  c.algorithm.loss = loss;
  c.estimator.kind = estimator;
  c.estimator.num_transforms = 3;
  c.estimator.num_components = 4;
  c.estimator.hidden_features = 30;
  c.training.learning_rate = 1e-3;
  return c;
}

// The estimate is a network trained on few simulations: its own error dominates the Monte Carlo
// error of 10,000 samples (1 % of a deviation). The bounds are those that an estimate from
// 2 x 2000 simulations keeps: a wrong correction (proposal instead of prior) shrinks the covariance
// by a factor of about two and misses them by far.
void expect_linear_gaussian(const PosteriorEstimationConfig& c) {
  const LinearGaussian task(3);
  const Prior prior = task.prior();
  VectorF x_o(3);
  x_o << 0.8f, -0.5f, 1.0f;
  const DirectPosterior posterior = infer(c, prior, task.simulator(), x_o, 1);
  constexpr Index n = 10'000;
  const RowMatrix samples = posterior.sample(n, {1, "posterior", 0, 0, 0});
  const Vector mean = samples.colwise().mean().transpose();
  const RowMatrix centred = samples.rowwise() - mean.transpose();
  const Eigen::MatrixXd covariance = centred.transpose() * centred / static_cast<double>(n);
  const Vector deviation = task.covariance().diagonal().cwiseSqrt();
  std::cout << "means off by " << ((mean - task.mean(x_o)).array() / deviation.array()).transpose()
            << " deviations; deviations over the exact ones "
            << (covariance.diagonal().array().sqrt() / deviation.array()).transpose() << '\n';
  for (Index d = 0; d < 3; ++d) {
    EXPECT_NEAR(mean(d), task.mean(x_o)(d), 0.25 * deviation(d)) << "mean " << d;
    EXPECT_NEAR(std::sqrt(covariance(d, d)) / deviation(d), 1.0, 0.15) << "deviation " << d;
    for (Index e = 0; e < d; ++e) {
      EXPECT_NEAR(covariance(d, e) / (deviation(d) * deviation(e)),
                  task.covariance()(d, e) / (deviation(d) * deviation(e)), 0.15);
    }
  }
}

TEST(NpeC, MafFindsTheLinearGaussianPosteriorInOneRound) {
  expect_linear_gaussian(config("maf", "atomic", 1, 4000));
}

TEST(NpeC, MafFindsTheLinearGaussianPosteriorOverRoundsWithTheAtomicLoss) {
  expect_linear_gaussian(config("maf", "atomic", 2, 2000));
}

TEST(NpeC, MixtureFindsTheLinearGaussianPosteriorOverRoundsWithTheAnalyticLoss) {
  expect_linear_gaussian(config("mdn", "analytic", 2, 2000));
}

TEST(NpeC, MixtureFindsTheLinearGaussianPosteriorOverRoundsWithTheAtomicLoss) {
  expect_linear_gaussian(config("mdn", "atomic", 2, 2000));
}

// Two moons (Greenberg et al. 2019, section 4.1): x = crescent + (-|t1 + t2|, t2 - t1) / sqrt 2, so
// that theta and its mirror image give the same x: two crescents at x_o = (0, 0).
VectorF two_moons(const Vector& theta, Stream& stream) {
  const double angle = std::numbers::pi * (stream.uniform() - 0.5);
  const double radius = 0.1 + 0.01 * stream.normal();
  VectorF x(2);
  x << static_cast<float>(radius * std::cos(angle) + 0.25 -
                          std::abs(theta(0) + theta(1)) / std::numbers::sqrt2),
      static_cast<float>(radius * std::sin(angle) + (theta(1) - theta(0)) / std::numbers::sqrt2);
  return x;
}

// Under the true posterior at x_o = 0, (|t1 + t2|, t1 - t2) / sqrt 2 is a crescent of radius 0.1
// around (0.25, 0), and t1 + t2 has either sign with probability 1/2.
TEST(NpeC, FindsBothCrescentsOfTwoMoons) {
  const Prior prior({{"t1", "1", Marginal::Kind::uniform, -1.0, 1.0},
                     {"t2", "1", Marginal::Kind::uniform, -1.0, 1.0}});
  PosteriorEstimationConfig c = config("maf", "atomic", 2, 2000);
  c.estimator.num_transforms = 5;
  c.estimator.hidden_features = 50;
  const DirectPosterior posterior = infer(c, prior, two_moons, VectorF::Zero(2), 1);
  constexpr Index n = 2000;
  const RowMatrix samples = posterior.sample(n, {1, "posterior", 0, 0, 0});
  Index positive = 0, near_crescent = 0;
  for (Index i = 0; i < n; ++i) {
    const double sum = (samples(i, 0) + samples(i, 1)) / std::numbers::sqrt2;
    const double difference = (samples(i, 0) - samples(i, 1)) / std::numbers::sqrt2;
    positive += sum > 0.0 ? 1 : 0;
    const double radius = std::hypot(std::abs(sum) - 0.25, difference);
    near_crescent += radius > 0.05 && radius < 0.15 ? 1 : 0;
  }
  std::cout << positive << " of " << n << " samples in one crescent, " << near_crescent
            << " within half a radius of either\n";
  EXPECT_GT(positive, n * 35 / 100);
  EXPECT_LT(positive, n * 65 / 100);
  // A uniform density on the same box has 3 % of its mass there.
  EXPECT_GT(near_crescent, n * 60 / 100);
}

TEST(NpeC, GradientOfEveryLossEqualsCentralDifferences) {
  // Single precision throughout: differences of the loss are good to about 1e-3.
  const LinearGaussian task(2);
  const Prior prior = task.prior();
  const RowMatrix theta = sample_prior(prior, 60, 1);
  const MatrixSource x(simulate(task.simulator(), theta, 1, 1));
  const FeatureTransform transform{VectorF::Zero(2), VectorF::Ones(2), {}};
  GaussianMixture proposal;
  proposal.log_weights = Vector::Zero(1);
  proposal.means = {Vector::Constant(2, 0.3)};
  proposal.precision_factors = {Eigen::MatrixXd::Identity(2, 2) * 1.5};
  TrainingData data{
      &x, prior.to_normal(theta).cast<float>(), std::vector<std::uint32_t>(60, 2), {proposal}};
  std::fill_n(data.round.begin(), 30, 1u);
  std::vector<std::uint32_t> rows(20);
  for (std::uint32_t i = 0; i < 20; ++i) rows[i] = 3 * i;
  const Batch batch{rows, 1, 0};

  for (const bool combined : {false, true}) {
    for (const auto& [kind, loss] :
         {std::pair{"maf", "atomic"}, {"mdn", "atomic"}, {"mdn", "analytic"}}) {
      PosteriorEstimationConfig c = config(kind, loss, 2, 30);
      c.estimator.hidden_features = 8;
      c.algorithm.combined_loss = combined;
      const auto network = make_network(c.estimator, 2, 0, 2, 1);
      Parameters<float> p = network.initial_parameters({1, "initial", 0, 0, 0});
      NpeC objective(c.algorithm, network, transform, data, {1, "train", 2, 0, 0});
      Parameters<float> gradient = Parameters<float>::Zero(p.size());
      objective.loss(p, batch, &gradient);
      // Along the gradient the slope is its norm.
      const float norm = gradient.norm();
      const Parameters<float> direction = gradient / norm;
      constexpr float step = 1e-2f;
      const double slope = (objective.loss(p + step * direction, batch, nullptr) -
                            objective.loss(p - step * direction, batch, nullptr)) /
                           (2.0 * static_cast<double>(step));
      EXPECT_NEAR(slope / static_cast<double>(norm), 1.0, 0.01) << kind << " " << loss;
    }
  }
}

TEST(NpeC, AnalyticLossNeedsAMixture) {
  AlgorithmConfig algorithm;
  algorithm.loss = "analytic";
  EstimatorConfig maf;
  EXPECT_THROW(resolve_loss(algorithm, maf), InputError);
}

}  // namespace
}  // namespace npdr::inference
