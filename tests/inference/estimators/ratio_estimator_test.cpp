#include "inference/estimators/ratio_estimator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "inference/algorithms/ratio_loss.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

RatioEstimator<double> small_network(Index blocks) {
  EstimatorConfig config;
  config.hidden_features = 9;
  config.num_hidden_layers = blocks;
  return {config, 3, 4};
}

// d/dparameters of sum_i w_i f_i, for 5 rows of x with 3 values of u each.
TEST(RatioEstimator, BackwardPassEqualsCentralDifferences) {
  for (const Index blocks : {1, 2, 3}) {
    const RatioEstimator<double> network = small_network(blocks);
    const Vector parameters = 2.0 * network.initial_parameters({1, "weights", 0, 0, 0});
    const RowMatrix u = random_matrix(15, 3, 2), x = random_matrix(5, 4, 3);
    const Vector weights = random_matrix(15, 1, 4).col(0);
    RatioScratch<double> scratch;
    const auto objective = [&](const Vector& p) {
      Vector logits;
      network.logits(p, u, x, scratch, logits);
      return weights.dot(logits);
    };
    objective(parameters);
    Vector gradient = Vector::Zero(network.num_parameters());
    network.backward(parameters, u, x, weights, scratch, gradient);
    expect_gradient(objective, parameters, gradient);
  }
}

TEST(RatioEstimator, StartsNearZero) {
  const RatioEstimator<double> network({}, 9, 20);
  RatioScratch<double> scratch;
  Vector logits;
  network.logits(network.initial_parameters({1, "weights", 0, 0, 0}), random_matrix(50, 9, 1),
                 random_matrix(50, 20, 2), scratch, logits);
  EXPECT_LT(logits.cwiseAbs().maxCoeff(), 0.5);
}

TEST(RatioEstimator, RejectsSizesBelowOne) {
  EstimatorConfig config;
  config.num_hidden_layers = 0;
  EXPECT_THROW(RatioEstimator<float>(config, 2, 2), InputError);
}

TEST(RatioLoss, GradientsEqualCentralDifferences) {
  const Vector logits = 3.0 * random_matrix(12, 1, 5).col(0);
  Vector gradient, unused;
  binary_ratio_loss(logits, gradient);
  expect_gradient([&](const Vector& f) { return binary_ratio_loss(f, unused); }, logits, gradient);
  for (const Index k : {2, 4}) {
    categorical_ratio_loss(logits, k, gradient);
    expect_gradient([&](const Vector& f) { return categorical_ratio_loss(f, k, unused); }, logits,
                    gradient);
  }
}

// Worked by hand: f = (log 3, 0): -log 0.75 - log 0.5; softmax: -log 0.75.
TEST(RatioLoss, MatchesACaseWorkedByHand) {
  const Vector logits = (Vector(2) << std::log(3.0), 0.0).finished();
  Vector unused;
  EXPECT_NEAR(binary_ratio_loss(logits, unused), -std::log(0.75 * 0.5), 1e-14);
  EXPECT_NEAR(categorical_ratio_loss(logits, 2, unused), -std::log(0.75), 1e-14);
}

}  // namespace
}  // namespace npdr::inference
