#include "inference/surrogate_posterior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "inference/estimators/ratio_estimator.h"
#include "tests/inference/cells.h"
#include "tests/thread_count.h"

namespace npdr::inference {
namespace {

// An untrained network with large weights: any density will do.
NetworkParts some_ratio(SamplerKind sampler) {
  NetworkParts parts{
      .prior = Prior({{"a", "1", Marginal::Kind::uniform, -1.0, 3.0},
                      {"b", "1", Marginal::Kind::uniform, 0.0, 1.0}}),
      .of_role =
          SurrogateParts{.is_ratio = true, .sampler = {.kind = sampler, .num_candidates = 20'000}},
      .estimator = {.kind = EstimatorKind::resnet, .hidden_features = 8},
      .structure_seed = 5,
      .transform = {VectorF::Zero(2), VectorF::Ones(2), {}},
      .parameters = {},
      .x_o = VectorF::Ones(2)};
  const RatioEstimator<float> network(parts.estimator, 2, 2);
  parts.parameters = 3.0f * network.initial_parameters({1, "initial", 0, 0, 0});
  return parts;
}

// Cells of the prior's box.
RowMatrix box_grid(Index n) { return cells_of({-1.0, 0.0}, {3.0, 1.0}, n); }

TEST(SurrogatePosterior, DensityIntegratesToOneAndEndsWithThePrior) {
  const auto posterior = make_posterior(some_ratio(SamplerKind::slice));
  constexpr Index n = 200;
  const double cell = 4.0 / (n * n);
  // 20,000 points of importance sampling with weights that vary by less than a factor of three.
  EXPECT_NEAR(posterior->log_prob(box_grid(n)).array().exp().sum() * cell, 1.0, 0.03);
  RowMatrix outside(1, 2);
  outside << 0.0, 1.5;
  EXPECT_EQ(posterior->log_prob(outside)(0), -kInfinity);
}

TEST(SurrogatePosterior, DensityUpToAConstantDiffersByAConstant) {
  const auto posterior = make_posterior(some_ratio(SamplerKind::slice));
  const RowMatrix theta = box_grid(5);
  const Vector difference = posterior->log_prob(theta) - posterior->relative_log_prob(theta);
  EXPECT_LT((difference.array() - difference(0)).abs().maxCoeff(), 1e-9);
}

TEST(SurrogatePosterior, BothSamplersHaveTheMeanOfTheDensity) {
  const RowMatrix points = box_grid(100);
  const auto reference = make_posterior(some_ratio(SamplerKind::slice));
  const Vector weights = reference->relative_log_prob(points).array().exp();
  const Eigen::RowVectorXd mean = (weights.transpose() * points) / weights.sum();
  for (const SamplerKind sampler : {SamplerKind::slice, SamplerKind::importance}) {
    const auto posterior = make_posterior(some_ratio(sampler));
    const Samples samples = posterior->draw(4000, {1, "posterior", 0, 0, 0});
    const RowMatrix centered = samples.theta.rowwise() - mean;
    const Eigen::RowVectorXd deviation = (centered.colwise().squaredNorm() / 4000.0).cwiseSqrt();
    // Five standard errors of 1000 independent samples, fewer than there are: a false-alarm rate
    // below 1e-5.
    const Eigen::RowVectorXd off = samples.theta.colwise().mean() - mean;
    EXPECT_LT((off.array().abs() / deviation.array()).maxCoeff(), 5.0 / std::sqrt(1000.0))
        << name_of(sampler);
    ASSERT_TRUE(samples.report);
    EXPECT_GT(samples.report->ess.minCoeff(), 1000.0) << name_of(sampler);
  }
}

TEST(SurrogatePosterior, ASampleDependsOnItsNumberAlone) {
  for (const SamplerKind sampler : {SamplerKind::slice, SamplerKind::importance}) {
    const auto posterior = make_posterior(some_ratio(sampler));
    const StreamId id{1, "posterior", 0, 0, 0};
    EXPECT_EQ(posterior->sample(150, id), posterior->sample(400, id).topRows(150))
        << name_of(sampler);
    const StreamId other{1, "proposal", 0, 0, 0};
    EXPECT_NE(posterior->sample(150, id), posterior->sample(150, other)) << name_of(sampler);
  }
}

TEST(SurrogatePosterior, SameBitsForAnyThreadCount) {
  for (const SamplerKind sampler : {SamplerKind::slice, SamplerKind::importance}) {
    const auto posterior = make_posterior(some_ratio(sampler));
    expect_same_for_any_thread_count([&] {
      return posterior->sample(300, {1, "posterior", 0, 0, 0});
    });
  }
}

}  // namespace
}  // namespace npdr::inference
