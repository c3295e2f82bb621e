#include "inference/samplers/tempered_chains.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/constants.h"
#include "core/error.h"
#include "core/log_sum_exp.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr Index kChainsDimension = 4;
const StreamId kChainsId{1, "posterior", 0, 0, 0};

// Gaussians, at least 8 of the wider one's deviations apart.
struct Mode {
  double weight, deviation;
  std::array<double, kChainsDimension> mean;
};
const std::array<Mode, 3> kModes{{{0.6, 0.03, {-0.13, 0.13, -0.13, 0.13}},
                                  {0.3, 0.045, {0.1, 0.1, 0.1, -0.1}},
                                  {0.1, 0.06, {-0.1, -0.3, 0.3, 0.3}}}};

Vector square_distances(const Mode& mode, const RowMatrix& u) {
  const Eigen::RowVectorXd mean = Eigen::RowVectorXd::Map(mode.mean.data(), kChainsDimension);
  return (u.rowwise() - mean).rowwise().squaredNorm();
}

// Of what makes these the posterior.
Vector log_likelihood(const RowMatrix& u) {
  std::vector<Vector> terms;
  for (const Mode& mode : kModes) {
    terms.emplace_back(-0.5 * square_distances(mode, u).array() / std::pow(mode.deviation, 2) +
                       std::log(mode.weight) - kChainsDimension * std::log(mode.deviation));
  }
  return log_sum_exp_of_terms(terms) - log_standard_normal(u);
}

Vector shares(const RowMatrix& u) {
  RowMatrix distances(u.rows(), std::ssize(kModes));
  for (std::size_t k = 0; k < kModes.size(); ++k) {
    distances.col(static_cast<Index>(k)) = square_distances(kModes[k], u);
  }
  Vector result = Vector::Zero(distances.cols());
  for (Index i = 0; i < u.rows(); ++i) {
    Index nearest = 0;
    distances.row(i).minCoeff(&nearest);
    result(nearest) += 1.0 / static_cast<double>(u.rows());
  }
  return result;
}

TemperedDraws draw(Index n, const SamplerConfig& config = {}, const StreamId& id = kChainsId) {
  return sample_tempered(log_likelihood, kChainsDimension, n, config, id);
}

// Mean over ten seeds. The error of each follows from the effective size that it reports.
TEST(TemperedChains, ModesHaveTheirShares) {
  constexpr int seeds = 10;
  Vector mean = Vector::Zero(3);
  double variance = 0.0;  // of the mean, divided by p (1 - p)
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const TemperedDraws draws = draw(2000, {}, {seed, "posterior", 0, 0, 0});
    mean += shares(draws.u) / seeds;
    variance += 1.0 / draws.report.ess.minCoeff() / (seeds * seeds);
    EXPECT_GT(draws.report.ess.minCoeff(), 100.0) << seed;
    EXPECT_LT(draws.report.r_hat.maxCoeff(), 1.1) << seed;
  }
  for (std::size_t k = 0; k < kModes.size(); ++k) {
    const double weight = kModes[k].weight;
    EXPECT_NEAR(mean(static_cast<Index>(k)), weight,
                4.0 * std::sqrt(weight * (1.0 - weight) * variance))
        << k;
  }
}

// Two walkers a population can't have modes of 0.6, 0.3 and 0.1 alike.
TEST(TemperedChains, PopulationsWhoseSharesDisagreeAreFound) {
  const TemperedDraws draws = draw(2000, {.num_chains = 8, .num_candidates = 1000});
  EXPECT_GT(draws.report.r_hat.maxCoeff(), 1.2);
  EXPECT_LT(draws.report.ess.minCoeff(), 20.0);
}

TEST(TemperedChains, EffectiveSizeIsThatOfAMeanWhereChainsMix) {
  // The prior again: independent draws, within five times the scatter of a variance of 200
  // families.
  const auto flat = [](const RowMatrix& u) -> Vector { return Vector::Zero(u.rows()); };
  const TemperedDraws draws = sample_tempered(flat, 2, 2000, {.num_chains = 200}, kChainsId);
  EXPECT_GT(draws.report.ess.minCoeff(), 2000.0 * (1.0 - 5.0 * std::sqrt(2.0 / 200.0)));
  EXPECT_LE(draws.report.ess.maxCoeff(), 2000.0);
  EXPECT_LT(draws.report.r_hat.maxCoeff(), 1.02);
}

TEST(TemperedChains, ADrawDependsOnItsNumberAlone) {
  const SamplerConfig config{.num_chains = 30, .num_candidates = 1000};
  const RowMatrix some = draw(20, config).u;
  EXPECT_EQ(some, draw(100, config).u.topRows(20));
  EXPECT_NE(some, draw(20, config, {1, "posterior", 0, 7, 0}).u);
}

TEST(TemperedChains, FewChainsAndCandidatesWillDo) {
  for (const Index count : {1, 5}) {
    const TemperedDraws draws = draw(40, {.num_chains = count, .num_candidates = count});
    EXPECT_TRUE(draws.u.allFinite());
    EXPECT_TRUE(draws.report.r_hat.allFinite());
  }
}

// Broken networks may say anything; half of the space is impossible, the rest a cliff.
TEST(TemperedChains, LikelihoodsThatAreNoNumbersAreNowhere) {
  const auto cliff = [](const RowMatrix& u) -> Vector {
    return u.col(0).unaryExpr([](double x) {
      if (x < -1.0) return kNaN;
      return x < 0.0 ? kInfinity : 1e30 * x;
    });
  };
  const SamplerConfig config{.num_chains = 8, .num_candidates = 100};
  EXPECT_GT(sample_tempered(cliff, 2, 20, config, kChainsId).u.col(0).minCoeff(), 0.0);
  const auto nowhere = [](const RowMatrix& u) -> Vector {
    return Vector::Constant(u.rows(), -kInfinity);
  };
  EXPECT_THROW(sample_tempered(nowhere, 2, 20, config, kChainsId), Error);
}

}  // namespace
}  // namespace npdr::inference
