#include "inference/truncated_prior.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/inference/linear_gaussian_check.h"

namespace npdr::inference {
namespace {

const StreamId kId{1, "proposal", 2, 0, 0};

// A posterior of D parameters that correlate, and are known to a third of the prior's deviations.
std::shared_ptr<const NetworkPosterior> some_posterior(Index dimension) {
  const LinearGaussian task(dimension);
  PosteriorEstimationConfig c = small_config(Algorithm::npe_c, EstimatorKind::maf, 1, 500);
  c.training.max_epochs = 60;
  return infer(c, task.prior(), task.simulator(), VectorF::Constant(dimension, 0.7f), 1);
}

TEST(TruncatedPrior, HoldsAllButTheLeastProbableSamplesOfThePosterior) {
  const auto posterior = some_posterior(3);
  const TruncatedPrior truncated(*posterior);
  const RowMatrix theta = posterior->sample(100'000, {7, "others", 0, 0, 0});
  const auto outside = 100'000 - static_cast<double>(truncated.rows_within(theta).size());
  // The share is that of the third least probable of 20,000: Gamma(3) / 20,000, and more than 5
  // in 10,000 has a probability of 3e-3.
  EXPECT_LT(outside, 50.0);
  // Rows far out in the prior are none of them.
  EXPECT_EQ(truncated.rows_within(RowMatrix::Constant(4, 3, -5.0)).size(), 0u);
}

// Draws of the prior that lie within the region are what draws are to be like.
TEST(TruncatedPrior, DrawsThePriorWithinTheRegion) {
  const auto posterior = some_posterior(3);
  const TruncatedPrior truncated(*posterior);
  constexpr Index n = 5000;
  const RowMatrix drawn = truncated.sample(n, kId);
  EXPECT_EQ(truncated.rows_within(drawn).size(), static_cast<std::size_t>(n));
  const RowMatrix prior = sample_prior(posterior->prior(), 400'000, {3, "prior", 0, 0, 0});
  const RowMatrix within = prior(truncated.rows_within(prior), Eigen::all);
  ASSERT_GT(within.rows(), 5000);
  // 15 % are five standard errors of a mean with the weights of 1000 draws (false-alarm rate 6e-7).
  const double share = static_cast<double>(within.rows()) / 400'000.0;
  EXPECT_NEAR(truncated.prior_mass(), share, 0.15 * share);
  const RowMatrix density[] = {posterior->log_prob(drawn), posterior->log_prob(within)};
  // Standard errors of means and of second moments, of both; five of them (false-alarm rate 1e-5
  // for 20 comparisons).
  const auto agree = [](const Vector& a, const Vector& b) {
    const auto error = [](const Vector& v) {
      return (v.array() - v.mean()).square().mean() / static_cast<double>(v.size());
    };
    return std::abs(a.mean() - b.mean()) < 5.0 * std::sqrt(error(a) + error(b));
  };
  EXPECT_TRUE(agree(density[0], density[1])) << density[0].mean() << ' ' << density[1].mean();
  for (Index d = 0; d < 3; ++d) {
    EXPECT_TRUE(agree(drawn.col(d), within.col(d))) << d;
    for (Index e = 0; e <= d; ++e) {
      EXPECT_TRUE(
          agree(drawn.col(d).cwiseProduct(drawn.col(e)), within.col(d).cwiseProduct(within.col(e))))
          << d << ' ' << e;
    }
  }
}

// The same posterior over parameters of another scale has the same region.
TEST(TruncatedPrior, DoesntDependOnTheScaleOfParameters) {
  const auto posterior = some_posterior(2);
  NetworkParts parts = posterior->parts();
  parts.prior = Prior({{"a", "1", Marginal::Kind::log_uniform, 1e-3, 10.0},
                       {"b", "1", Marginal::Kind::uniform, -1.0, 3.0}});
  const auto scaled = make_posterior(parts);
  const RowMatrix theta = sample_prior(posterior->prior(), 20'000, {3, "prior", 0, 0, 0});
  const auto rows = TruncatedPrior(*posterior).rows_within(theta);
  EXPECT_GT(rows.size(), 500u);
  const RowMatrix theirs = parts.prior.to_theta(posterior->prior().to_normal(theta));
  EXPECT_EQ(TruncatedPrior(*scaled).rows_within(theirs), rows);
}

TEST(TruncatedPrior, RowsDependOnNoOthers) {
  const auto posterior = some_posterior(2);
  const TruncatedPrior truncated(*posterior);
  const RowMatrix many = truncated.sample(1200, kId);
  EXPECT_EQ(truncated.sample(700, kId), many.topRows(700));
  EXPECT_EQ(TruncatedPrior(*posterior).sample(700, kId), many.topRows(700));
  StreamId second = kId;
  second.row = 500;
  EXPECT_EQ(truncated.sample(500, second), many.middleRows(500, 500));
}

// No two are the same, however few of the candidates count.
TEST(TruncatedPrior, DrawsDiffer) {
  const auto posterior = some_posterior(12);
  const RowMatrix drawn = TruncatedPrior(*posterior).sample(500, kId);
  std::vector<double> first(drawn.col(0).begin(), drawn.col(0).end());
  std::ranges::sort(first);
  EXPECT_EQ(std::ranges::adjacent_find(first), first.end());
}

}  // namespace
}  // namespace npdr::inference
