#include "inference/particle_posterior.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "tests/inference/tasks.h"

namespace npdr::inference {
namespace {

Prior unit_box(Index d) {
  std::vector<Marginal> marginals;
  for (Index k = 0; k < d; ++k) {
    marginals.push_back({std::string(static_cast<std::size_t>(k + 1), 'p'), "1",
                         Marginal::Kind::uniform, 0.0, 1.0});
  }
  return Prior(marginals);
}

ParticleParts parts_of(const RowMatrix& theta, const Vector& weights) {
  return {.prior = unit_box(theta.cols()), .theta = theta, .weights = weights};
}

TEST(ParticlePosterior, EqualParticlesAreDrawnOnceEach) {
  const RowMatrix theta = sample_prior(unit_box(2), 50, 1);
  const ParticlePosterior posterior(parts_of(theta, Vector::Ones(50)));
  const RowMatrix drawn = posterior.sample(120, {1, "test", 0, 0, 0});
  std::vector<double> expected(theta.col(0).begin(), theta.col(0).end());
  std::sort(expected.begin(), expected.end());
  for (const Index begin : {0, 50}) {
    const Vector block = drawn.col(0).segment(begin, 50);
    std::vector<double> found(block.begin(), block.end());
    EXPECT_NE(found, expected) << "in a random order";
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
  EXPECT_EQ(posterior.sample(70, {1, "test", 0, 0, 0}), drawn.topRows(70));
}

// Counts of n = 30,000 draws: standard deviation at most sqrt(n / 4) = 87; 5 of them are exceeded
// once in 10^6.
TEST(ParticlePosterior, DrawsByWeightAndReportsTheEffectiveSize) {
  const RowMatrix theta = Eigen::Vector4d(0.1, 0.2, 0.3, 0.4);
  const Vector weights = Eigen::Vector4d(0.5, 0.0, 0.25, 0.25);
  const ParticlePosterior posterior(parts_of(theta, weights));
  constexpr Index n = 30'000;
  const Samples samples = posterior.draw(n, {1, "test", 0, 0, 0});
  for (Index k = 0; k < 4; ++k) {
    const auto count = static_cast<double>((samples.theta.array() == theta(k)).count());
    EXPECT_NEAR(count, weights(k) * double(n), 5 * 87) << k;
  }
  ASSERT_TRUE(samples.report);
  EXPECT_EQ(samples.report->r_hat.size(), 0);
  EXPECT_NEAR(samples.report->ess(0), 8.0 / 3.0, 1e-12);
  EXPECT_EQ(posterior.sample(10, {1, "test", 0, 5, 0}), samples.theta.middleRows(5, 10));
}

// Kernels over u leak nothing: the density integrates to 1 over the box. Trapezoids of 2000 over a
// density that vanishes at the borders are exact to 1e-3.
TEST(ParticlePosterior, DensityIntegratesToOneOverThePrior) {
  const RowMatrix theta = sample_prior(unit_box(1), 40, 2).array() * 0.3;  // against a border
  const ParticlePosterior posterior(parts_of(theta, Vector::Ones(40)));
  constexpr Index n = 2000;
  RowMatrix grid(n, 1);
  for (Index i = 0; i < n; ++i) grid(i, 0) = (double(i) + 0.5) / double(n);
  EXPECT_NEAR(posterior.log_prob(grid).array().exp().mean(), 1.0, 1e-3);
  EXPECT_EQ(posterior.log_prob(RowMatrix::Constant(1, 1, 1.5))(0), -kInfinity);
}

TEST(ParticlePosterior, SmoothSamplesAreNewAndStayInsideOfThePrior) {
  ParticleParts parts = parts_of(sample_prior(unit_box(2), 30, 3), Vector::Ones(30));
  parts.smooth = true;
  const ParticlePosterior posterior(parts);
  const RowMatrix drawn = posterior.sample(500, {1, "test", 0, 0, 0});
  for (Index i = 0; i < drawn.rows(); ++i) {
    EXPECT_TRUE(parts.prior.contains(drawn.row(i).transpose()));
    EXPECT_FALSE((parts.theta.col(0).array() == drawn(i, 0)).any());
  }
}

TEST(ParticlePosterior, ParticlesMayLieOutsideOfThePrior) {
  ParticleParts parts = parts_of(sample_prior(unit_box(2), 40, 4).array() + 5.0, Vector::Ones(40));
  parts.theta.col(1).setConstant(0.5);
  parts.theta(7, 0) = kInfinity;
  parts.space = ParticleSpace::theta;
  const ParticlePosterior posterior(parts);
  const Vector best = posterior.map({1, "map", 0, 0, 0});
  EXPECT_GT(best(0), 5.0);
  EXPECT_LT(best(0), 6.0);
  const Vector log_prob = posterior.log_prob(parts.theta);
  EXPECT_EQ(log_prob(7), -kInfinity);
  EXPECT_GT(posterior.log_prob(best.transpose())(0), std::log(0.5)) << "40 in an interval of 1";
}

// Chains that stay where they are don't agree.
TEST(ParticlePosterior, ChainsHaveTheirDiagnostics) {
  constexpr Index chains = 10, draws = 20;
  RowMatrix stuck(chains * draws, 1), mixed(chains * draws, 1);
  for (Index i = 0; i < stuck.rows(); ++i) {
    stuck(i, 0) = 0.05 + 0.09 * double(i % chains);
    mixed(i, 0) = Stream({1, "mixed", 0, static_cast<std::uint64_t>(i), 0}).uniform();
    stuck(i, 0) += 1e-3 * mixed(i, 0);
  }
  const auto report_of = [&](const RowMatrix& theta) {
    ParticleParts parts = parts_of(theta, Vector::Ones(theta.rows()));
    parts.num_chains = chains;
    return *ParticlePosterior(parts).draw(1, {1, "test", 0, 0, 0}).report;
  };
  EXPECT_GT(report_of(stuck).r_hat(0), 5.0);
  EXPECT_LT(report_of(mixed).r_hat(0), 1.1);
  EXPECT_GT(report_of(mixed).ess(0), 50.0);
}

TEST(ParticlePosterior, RejectsPartsThatDontGoTogether) {
  const RowMatrix theta = sample_prior(unit_box(1), 4, 1);
  EXPECT_THROW(ParticlePosterior(parts_of(theta, Vector::Ones(3))), ShapeError);
  EXPECT_THROW(ParticlePosterior(parts_of(theta, Vector::Zero(4))), InputError);
  EXPECT_THROW(ParticlePosterior(parts_of(theta, -Vector::Ones(4))), InputError);
  EXPECT_THROW(ParticlePosterior(parts_of(theta, Eigen::Vector4d(0, 1, 0, 0))), InputError);
  ParticleParts parts = parts_of(theta, Vector::Ones(4));
  parts.num_chains = 3;
  EXPECT_THROW(ParticlePosterior{parts}, ShapeError);
}

}  // namespace
}  // namespace npdr::inference
