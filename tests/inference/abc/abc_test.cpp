#include "inference/abc/abc.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "inference/abc/abc_smc.h"
#include "inference/abc/acceptance.h"
#include "inference/particle_posterior.h"
#include "inference/weighted_population.h"
#include "tests/inference/tasks.h"
#include "tests/message_of.h"

namespace npdr::inference {
namespace {

TEST(Acceptance, TakesTheNearestAndOfTiesTheFirst) {
  Vector distances(8);
  distances << 3.0, 1.0, kInfinity, 2.0, 1.0, 2.0, 2.0, kNaN;
  EXPECT_EQ(accept_nearest(distances, 0.5).rows, (std::vector<Index>{1, 3, 4, 5}));
  EXPECT_EQ(accept_nearest(distances, 0.5).epsilon, 2.0);
  EXPECT_EQ(accept_nearest(distances, 0.25).rows, (std::vector<Index>{1, 4}));
  EXPECT_EQ(accept_nearest(distances, 1e-6).rows, (std::vector<Index>{1}));
  EXPECT_EQ(accept_nearest(distances, 1.0).rows, (std::vector<Index>{0, 1, 3, 4, 5, 6}))
      << "what failed is never accepted";
  EXPECT_EQ(accept_within(distances, 2.0).rows, (std::vector<Index>{1, 3, 4, 5, 6}));
  EXPECT_TRUE(accept_nearest(Vector::Constant(3, kInfinity), 0.5).rows.empty());
}

TEST(Acceptance, TooFewSayWhatToChange) {
  EXPECT_TRUE(says(message_of<Error>([] {
                     require_enough({{3, 5}, 0.25}, Vector::Ones(100), 2);
                   }),
                   {"ABC accepted 2 of 100 simulations (epsilon = 0.25)", "must be > 2",
                    "raise abc.quantile, abc.epsilon or num_simulations"}));
  EXPECT_TRUE(says(message_of<Error>([] {
                     require_enough({{}, 0.0}, Vector::Constant(4, kInfinity), 2);
                   }),
                   {"ABC accepted 0 of 4 simulations", "4 failed: narrow the prior"}));
}

/// d(x, x_o) of theta, with the stream of its row.
using TestDistance = std::function<double(const Vector& theta, Stream& stream)>;

AbcRound simulated(const TestDistance& distance, const RowMatrix& theta, std::uint64_t round) {
  AbcRound result{theta, Vector(theta.rows())};
  for (Index i = 0; i < theta.rows(); ++i) {
    Stream stream({1, "simulate", round, static_cast<std::uint64_t>(i), 0});
    result.distances(i) = distance(theta.row(i).transpose(), stream);
  }
  return result;
}

AbcPopulation run(Algorithm algorithm, const AbcConfig& config, const Prior& prior,
                  const TestDistance& distance, Index n, std::uint64_t rounds) {
  AbcPopulation population =
      advance(algorithm, config, prior, simulated(distance, sample_prior(prior, n, 1), 1), {},
              {1, "abc", 1, 0, 0});
  for (std::uint64_t r = 2; r <= rounds; ++r) {
    const RowMatrix theta = propose(algorithm, prior, population, n, {1, "proposal", r, 0, 0});
    population = advance(algorithm, config, prior, simulated(distance, theta, r), population,
                         {1, "abc", r, 0, 0});
  }
  return population;
}

// theta ~ N(0, 1), x = theta + N(0, 0.3^2) in each of D dimensions, d = max_d |x_d - x_o,d|: the
// observation is uniform within epsilon around x. For each dimension by itself the ABC posterior
// has mean and variance of the integral over x of the posteriors at x,
//   mean = b E[x],  variance = c + b^2 Var[x],   b = 1 / (1 + s^2), c = s^2 b,
// x ~ N(0, 1 + s^2) cut off to [x_o - epsilon, x_o + epsilon].
struct BoxTask {
  Vector x_o;
  double noise = 0.3;

  TestDistance distance() const {
    return [this](const Vector& theta, Stream& stream) {
      double largest = 0.0;
      for (Index d = 0; d < theta.size(); ++d) {
        largest = std::max(largest, std::abs(theta(d) + noise * stream.normal() - x_o(d)));
      }
      return largest;
    };
  }

  // Mean and variance of theta_d at a threshold, x's moments by the midpoint rule.
  std::pair<double, double> moments(Index d, double epsilon) const {
    const double b = 1.0 / (1.0 + noise * noise);
    double mass = 0.0, first = 0.0, second = 0.0;
    constexpr int cells = 2000;
    for (int i = 0; i < cells; ++i) {
      const double x = x_o(d) + epsilon * ((i + 0.5) / cells * 2.0 - 1.0);
      const double p = std::exp(-0.5 * b * x * x);
      mass += p;
      first += p * x;
      second += p * x * x;
    }
    const double mean = first / mass, variance = second / mass - mean * mean;
    return {b * mean, noise * noise * b + b * b * variance};
  }
};

// Against the closed form within 5 standard errors of `effective` draws, of the mean and, as sqrt(2
// / n), of the variance: exceeded once in 10^6.
void expect_box_posterior(const BoxTask& task, const AbcPopulation& population, const Prior& prior,
                          double effective) {
  ASSERT_GT(effective, 100.0);
  const RowMatrix u = prior.to_normal(population.theta);
  const Vector mean = weighted_mean(u, population.weights);
  const Eigen::MatrixXd covariance = weighted_covariance(u, population.weights);
  for (Index d = 0; d < u.cols(); ++d) {
    const auto [exact_mean, exact_variance] = task.moments(d, population.epsilon);
    EXPECT_NEAR(mean(d), exact_mean, 5.0 * std::sqrt(exact_variance / effective));
    EXPECT_NEAR(covariance(d, d) / exact_variance, 1.0, 5.0 * std::sqrt(2.0 / effective));
  }
  EXPECT_LE(population.distances.maxCoeff(), population.epsilon);
}

const BoxTask kBox{Eigen::Vector2d(0.8, -0.5)};

TEST(AbcRejection, HasTheClosedFormOfItsThreshold) {
  const Prior prior = LinearGaussian(2).prior();
  const AbcPopulation wide =
      run(Algorithm::abc_rejection, {.quantile = 0.1}, prior, kBox.distance(), 20'000, 1);
  EXPECT_EQ(wide.theta.rows(), 2000);
  expect_box_posterior(kBox, wide, prior, 2000.0);
  const AbcPopulation fixed =
      run(Algorithm::abc_rejection, {.epsilon = 0.2}, prior, kBox.distance(), 20'000, 1);
  EXPECT_EQ(fixed.epsilon, 0.2);
  expect_box_posterior(kBox, fixed, prior, static_cast<double>(fixed.theta.rows()));
}

TEST(AbcMcmc, HasTheClosedFormOfItsThreshold) {
  const Prior prior = LinearGaussian(2).prior();
  constexpr Index chains = 100;
  const AbcPopulation found =
      run(Algorithm::abc_mcmc, {.quantile = 0.1}, prior, kBox.distance(), chains, 1000);
  ASSERT_EQ(found.theta.rows(), 500 * chains) << "rounds 501 to 1000";
  const ParticlePosterior posterior({.prior = prior,
                                     .theta = found.theta,
                                     .weights = found.weights,
                                     .num_chains = found.num_chains});
  const SamplerReport report = *posterior.draw(1, {1, "test", 0, 0, 0}).report;
  EXPECT_LT(report.r_hat.maxCoeff(), 1.1);
  expect_box_posterior(kBox, found, prior, report.ess.minCoeff());
}

TEST(AbcSmc, HasTheClosedFormOfItsThresholdWhichShrinks) {
  const Prior prior = LinearGaussian(2).prior();
  const AbcConfig config{.quantile = 0.3};
  const AbcPopulation first = run(Algorithm::abc_smc, config, prior, kBox.distance(), 5000, 1);
  const AbcPopulation found = run(Algorithm::abc_smc, config, prior, kBox.distance(), 5000, 4);
  EXPECT_LT(found.epsilon, 0.5 * first.epsilon);
  EXPECT_NEAR(found.weights.sum(), 1.0, 1e-12);
  expect_box_posterior(kBox, found, prior, effective_size(found.weights));
}

TEST(AbcSmc, ThresholdsEndAtEpsilon) {
  const Prior prior = LinearGaussian(2).prior();
  const AbcConfig config{.quantile = 0.2, .epsilon = 0.3};
  // Round 1 is rejection within epsilon, and so are all that follow.
  for (const std::uint64_t rounds : {1, 3}) {
    EXPECT_EQ(run(Algorithm::abc_smc, config, prior, kBox.distance(), 2000, rounds).epsilon, 0.3);
  }
}

// Two particles of weights 3/4 and 1/4 at -1 and 1 in one dimension: covariance 3/4 / (1 - 5/8) =
// 2, K = 4.
TEST(AbcSmc, WeightsAreThoseOfTheFormula) {
  const Prior prior = LinearGaussian(1).prior();
  AbcPopulation previous{.theta = Eigen::Vector2d(-1.0, 1.0),
                         .weights = Eigen::Vector2d(0.75, 0.25),
                         .distances = Eigen::Vector2d(1.0, 2.0),
                         .epsilon = 2.0,
                         .kernel = {}};
  previous.kernel = twice_the_covariance(prior, previous);
  EXPECT_NEAR(previous.kernel(0, 0), 4.0, 1e-12);
  const Eigen::Vector4d theta(0.5, -2.0, 3.0, 1.0);
  const AbcRound round{theta, Eigen::Vector4d(0.5, 1.0, 0.7, 1.1)};
  const AbcPopulation next = next_population({.quantile = 0.5}, prior, round, previous);
  ASSERT_EQ(next.theta.rows(), 3) << "within 1, the nearer half of the last distances";
  const auto weight = [](double u) {
    return std::exp(-0.5 * u * u) / (0.75 * std::exp(-(u + 1.0) * (u + 1.0) / 8.0) +
                                     0.25 * std::exp(-(u - 1.0) * (u - 1.0) / 8.0));
  };
  const Eigen::Vector3d expected(weight(0.5), weight(-2.0), weight(3.0));
  EXPECT_LT((next.weights - expected / expected.sum()).norm(), 1e-12);
}

// x = theta^2: two modes at +-1 of equal mass. Shares of 500 effective draws are within 5 sqrt(1 /
// 4 / 500) = 0.11 of one half (once in 10^6).
TEST(Abc, BothModesAreKept) {
  const Prior prior = LinearGaussian(1).prior();
  const TestDistance distance = [](const Vector& theta, Stream&) {
    return std::abs(theta(0) * theta(0) - 1.0);
  };
  for (const auto& [algorithm, rounds, n] :
       {std::tuple(Algorithm::abc_rejection, 1, 20'000), std::tuple(Algorithm::abc_mcmc, 10, 2000),
        std::tuple(Algorithm::abc_smc, 3, 5000)}) {
    const AbcPopulation found =
        run(algorithm, {.quantile = 0.1}, prior, distance, n, static_cast<std::uint64_t>(rounds));
    const double right =
        (found.theta.col(0).array() > 0.0).cast<double>().matrix().dot(found.weights);
    EXPECT_NEAR(right, 0.5, 0.11) << name_of(algorithm);
    EXPECT_LT((found.theta.array().abs() - 1.0).abs().maxCoeff(), 0.25) << name_of(algorithm);
  }
}

TEST(AbcMcmc, ChainsStayWhereTheirProposalsFail) {
  const Prior prior = LinearGaussian(1).prior();
  AbcPopulation chains{.theta = Eigen::Vector2d(0.5, -0.5),
                       .weights = Eigen::Vector2d(0.5, 0.5),
                       .distances = Eigen::Vector2d(0.1, 0.2),
                       .epsilon = 1.0,
                       .kernel = Eigen::MatrixXd::Identity(1, 1),
                       .num_chains = 2};
  const AbcRound failed{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(kInfinity, 1.5)};
  chains = advance(Algorithm::abc_mcmc, {}, prior, failed, chains, {1, "abc", 2, 0, 0});
  EXPECT_EQ(chains.theta, RowMatrix(Eigen::Vector2d(0.5, -0.5))) << "round 2 alone";
  // Nearer to the prior's mean: the ratio is above 1.
  const AbcRound good{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.3, 0.4)};
  chains = advance(Algorithm::abc_mcmc, {}, prior, good, chains, {1, "abc", 3, 0, 0});
  EXPECT_EQ(chains.theta, RowMatrix(Eigen::Vector4d(0.5, -0.5, 0.0, 0.0))) << "rounds 2 and 3";
  EXPECT_EQ(chains.distances, Vector(Eigen::Vector4d(0.1, 0.2, 0.3, 0.4)));
  EXPECT_THROW(propose(Algorithm::abc_mcmc, prior, chains, 3, {1, "proposal", 4, 0, 0}),
               InputError);
}

TEST(Abc, ProposalsDependOnTheirRowAlone) {
  const Prior prior = LinearGaussian(2).prior();
  for (const Algorithm algorithm : {Algorithm::abc_smc, Algorithm::abc_mcmc}) {
    const AbcPopulation population = run(algorithm, {}, prior, kBox.distance(), 200, 1);
    const RowMatrix all = propose(algorithm, prior, population, 200, {1, "proposal", 2, 0, 0});
    EXPECT_EQ(propose(algorithm, prior, population, 200, {1, "proposal", 2, 0, 0}), all);
  }
  const AbcPopulation population = run(Algorithm::abc_smc, {}, prior, kBox.distance(), 200, 1);
  const RowMatrix all =
      propose(Algorithm::abc_smc, prior, population, 50, {1, "proposal", 2, 0, 0});
  EXPECT_EQ(propose(Algorithm::abc_smc, prior, population, 7, {1, "proposal", 2, 0, 0}),
            all.topRows(7));
  EXPECT_THROW(propose(Algorithm::abc_rejection, prior, population, 7, {1, "proposal", 2, 0, 0}),
               InputError);
  AbcPopulation without = population;
  without.kernel.resize(0, 0);
  EXPECT_THROW(propose(Algorithm::abc_smc, prior, without, 7, {1, "proposal", 2, 0, 0}),
               InputError);
}

}  // namespace
}  // namespace npdr::inference
