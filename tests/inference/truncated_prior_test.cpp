#include "inference/truncated_prior.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/inference/linear_gaussian_check.h"

namespace npdr::inference {
namespace {

const StreamId kProposalId{1, "proposal", 2, 0, 0};

// A posterior of D parameters that correlate, and are known to a third of the prior's deviations.
std::shared_ptr<const NetworkPosterior> some_posterior(Index dimension) {
  const LinearGaussian task(dimension);
  PosteriorEstimationConfig c = small_config(Algorithm::npe_c, EstimatorKind::maf, 1, 500);
  c.training.max_epochs = 60;
  return infer(c, task.prior(), task.simulator(), VectorF::Constant(dimension, 0.7f), 1);
}

// A pool that is wider than the q that candidates come from, and one that is narrower.
std::shared_ptr<const NetworkPosterior> pool_with(PoolPowers powers) {
  const LinearGaussian task(2);
  PosteriorEstimationConfig c = small_config(Algorithm::npe_nle, EstimatorKind::maf, 1, 500);
  c.training.max_epochs = 60;
  const auto learned = infer(c, task.prior(), task.simulator(), VectorF::Constant(2, 0.7f), 1);
  NetworkParts parts = learned->parts();
  std::get<DirectParts>(parts.of_role).likelihood->powers = powers;
  return make_posterior(parts);
}

double share_outside(const NetworkPosterior& posterior) {
  constexpr Index n = 20'000;
  const RowMatrix theta = posterior.sample(n, {7, "others", 0, 0, 0});
  const auto within = TruncatedPrior(posterior).rows_within(theta).size();
  return 1.0 - static_cast<double>(within) / static_cast<double>(n);
}

TEST(TruncatedPrior, HoldsAllButTheLeastProbableSamplesOfThePosterior) {
  // Of 20,000 samples 2 are expected, more than 10 with a probability of 1e-5; the share that lies
  // outside is itself told by some draws, and may be twice as large.
  EXPECT_LT(share_outside(*some_posterior(3)), 8e-4);
  EXPECT_LT(share_outside(*pool_with({0.5, 0.2})), 8e-4) << "wider";
  EXPECT_LT(share_outside(*pool_with({0.9, 0.8})), 8e-4) << "narrower";
  // Rows far out in the prior are none of them.
  const auto posterior = some_posterior(3);
  EXPECT_EQ(TruncatedPrior(*posterior).rows_within(RowMatrix::Constant(4, 3, -5.0)).size(), 0u);
}

// Draws of the prior that lie within the region are what draws are to be like.
TEST(TruncatedPrior, DrawsThePriorWithinTheRegion) {
  const auto posterior = some_posterior(3);
  const TruncatedPrior truncated(*posterior);
  constexpr Index n = 5000;
  const RowMatrix drawn = truncated.sample(n, kProposalId);
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
  const RowMatrix many = truncated.sample(1200, kProposalId);
  EXPECT_EQ(truncated.sample(700, kProposalId), many.topRows(700));
  EXPECT_EQ(TruncatedPrior(*posterior).sample(700, kProposalId), many.topRows(700));
  StreamId second = kProposalId;
  second.row = 500;
  EXPECT_EQ(truncated.sample(500, second), many.middleRows(500, 500));
}

// No two are the same, however few of the candidates count.
TEST(TruncatedPrior, DrawsDiffer) {
  const auto posterior = some_posterior(12);
  const RowMatrix drawn = TruncatedPrior(*posterior).sample(500, kProposalId);
  std::vector<double> first(drawn.col(0).begin(), drawn.col(0).end());
  std::ranges::sort(first);
  EXPECT_EQ(std::ranges::adjacent_find(first), first.end());
}

}  // namespace
}  // namespace npdr::inference
