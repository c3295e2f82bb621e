#include "inference/algorithms/npe_c.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "core/error.h"
#include "tests/inference/algorithms/objective_check.h"
#include "tests/inference/gradient_check.h"
#include "tests/inference/linear_gaussian_check.h"

namespace npdr::inference {
namespace {

PosteriorEstimationConfig config(EstimatorKind estimator, Loss loss, Index rounds,
                                 Index simulations) {
  PosteriorEstimationConfig c = small_config(Algorithm::npe_c, estimator, rounds, simulations);
  c.algorithm.loss = loss;
  return c;
}

TEST(NpeC, MafFindsTheLinearGaussianPosteriorOverRoundsWithTheAtomicLoss) {
  expect_linear_gaussian(config(EstimatorKind::maf, Loss::atomic, 2, 2000));
}

TEST(NpeC, MixtureFindsTheLinearGaussianPosteriorOverRoundsWithTheAnalyticLoss) {
  expect_linear_gaussian(config(EstimatorKind::mdn, Loss::analytic, 2, 2000));
}

TEST(NpeC, MixtureFindsTheLinearGaussianPosteriorOverRoundsWithTheAtomicLoss) {
  expect_linear_gaussian(config(EstimatorKind::mdn, Loss::atomic, 2, 2000));
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
  PosteriorEstimationConfig c = config(EstimatorKind::maf, Loss::atomic, 2, 2000);
  c.estimator.num_transforms = 5;
  c.estimator.hidden_features = 50;
  const auto posterior = infer(c, prior, two_moons, VectorF::Zero(2), 1);
  constexpr Index n = 2000;
  const RowMatrix samples = posterior->sample(n, {1, "posterior", 0, 0, 0});
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
  const SmallBatch small;
  for (const bool combined : {false, true}) {
    for (const auto& [kind, loss] : {std::pair{EstimatorKind::maf, Loss::atomic},
                                     {EstimatorKind::mdn, Loss::atomic},
                                     {EstimatorKind::mdn, Loss::analytic}}) {
      PosteriorEstimationConfig c = config(kind, loss, 2, 30);
      c.estimator.hidden_features = 8;
      c.algorithm.combined_loss = combined;
      const auto network = make_network(c.estimator, 2, {}, 2, 1);
      TrainingData data = small.data;
      if (loss == Loss::atomic) data.proposals.clear();
      NpeC objective(c.algorithm, network, small.transform, data, {1, "train", 2, 0, 0});
      expect_slope_is_gradient(objective, network.initial_parameters({1, "initial", 0, 0, 0}),
                               small.batch(), name_of(kind) + " " + name_of(loss));
    }
  }
}

TEST(NpeC, AnalyticLossNeedsAMixture) {
  const AlgorithmConfig algorithm{.loss = Loss::analytic};
  EXPECT_THROW(resolve_loss(algorithm, EstimatorKind::maf), InputError);
  const SmallBatch small;
  const auto flow = make_network({}, 2, {}, 2, 1);
  EXPECT_THROW(NpeC(algorithm, flow, small.transform, small.data, {1, "train"}), Error);
}

TEST(NpeC, LossSuitsTheEstimatorWhenLeftToIt) {
  EXPECT_EQ(resolve_loss({}, EstimatorKind::mdn), Loss::analytic);
  EXPECT_EQ(resolve_loss({}, EstimatorKind::nsf), Loss::atomic);
  EXPECT_EQ(resolve_loss({.loss = Loss::atomic}, EstimatorKind::mdn), Loss::atomic);
}

}  // namespace
}  // namespace npdr::inference
