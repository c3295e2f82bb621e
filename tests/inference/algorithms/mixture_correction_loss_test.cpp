#include "inference/algorithms/mixture_correction_loss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/log_sum_exp.h"
#include "core/normal.h"
#include "tests/inference/cells.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

GaussianMixture random_mixture(Index components, Index dimension, std::uint64_t seed) {
  GaussianMixture mixture;
  mixture.log_weights = random_matrix(components, 1, seed).col(0);
  mixture.log_weights.array() -= log_sum_exp(mixture.log_weights);
  for (Index k = 0; k < components; ++k) {
    const auto offset = static_cast<std::uint64_t>(10 * (k + 1));
    mixture.means.push_back(random_matrix(dimension, 1, seed + offset).col(0));
    Eigen::MatrixXd factor = 0.3 * random_matrix(dimension, dimension, seed + offset + 1);
    factor.diagonal().setConstant(1.2);
    factor.triangularView<Eigen::StrictlyLower>().setZero();
    mixture.precision_factors.push_back(factor);
  }
  return mixture;
}

// Z = integral of q(u) p~(u) / N(u; 0, I) du, on a grid in two dimensions.
TEST(MixtureCorrectionLoss, NormalizerEqualsTheIntegral) {
  const GaussianMixture q = random_mixture(3, 2, 1);
  const GaussianMixture proposal = narrower_than_prior(random_mixture(2, 2, 100));
  constexpr Index side = 800;
  constexpr double width = 20.0 / side;
  const RowMatrix u = cells_of({-10.0, -10.0}, {10.0, 10.0}, side);
  const Vector log_prior = -0.5 * u.rowwise().squaredNorm().array() + 2.0 * log_normal_density(0.0);
  const double integral =
      (q.log_prob(u) + proposal.log_prob(u) - log_prior).array().exp().sum() * width * width;
  EXPECT_NEAR(MixtureCorrection(proposal).log_normalizer(q, nullptr), std::log(integral), 1e-8);
}

// All parameters of q in one vector, and back.
Vector flatten(const Vector& weights, const std::vector<Vector>& means,
               const std::vector<Eigen::MatrixXd>& factors) {
  std::vector<double> values(weights.begin(), weights.end());
  for (std::size_t k = 0; k < means.size(); ++k) {
    values.insert(values.end(), means[k].begin(), means[k].end());
    for (Index i = 0; i < means[k].size(); ++i) {
      for (Index j = i; j < means[k].size(); ++j) values.push_back(factors[k](i, j));
    }
  }
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

GaussianMixture unflatten(const Vector& values, GaussianMixture mixture) {
  Index next = 0;
  for (double& w : mixture.log_weights) w = values(next++);
  for (std::size_t k = 0; k < mixture.means.size(); ++k) {
    for (double& m : mixture.means[k]) m = values(next++);
    for (Index i = 0; i < mixture.dimension(); ++i) {
      for (Index j = i; j < mixture.dimension(); ++j) {
        mixture.precision_factors[k](i, j) = values(next++);
      }
    }
  }
  return mixture;
}

// Eleven components of the proposal: a block of eight, and one that isn't full.
TEST(MixtureCorrectionLoss, GradientEqualsCentralDifferences) {
  const GaussianMixture q = random_mixture(3, 3, 1);
  MixtureCorrection correction(narrower_than_prior(random_mixture(11, 3, 100)));
  GaussianMixtureGradient gradient;
  correction.log_normalizer(q, &gradient);
  expect_gradient(
      [&](const Vector& p) { return correction.log_normalizer(unflatten(p, q), nullptr); },
      flatten(q.log_weights, q.means, q.precision_factors),
      flatten(gradient.log_weights, gradient.means, gradient.precision_factors));
}

const GaussianMixture kStandard{
    Vector::Zero(1), {Vector::Zero(3)}, {Eigen::MatrixXd::Identity(3, 3)}};

TEST(MixtureCorrectionLoss, NormalizerIsOneWhenTheProposalIsThePrior) {
  EXPECT_NEAR(MixtureCorrection(kStandard).log_normalizer(random_mixture(3, 3, 1), nullptr), 0.0,
              1e-12);
}

// Networks forget components by making them flat: their precision is singular up to rounding, and
// so is A where the proposal is as wide as the prior. Z is 1 there whatever q is.
TEST(MixtureCorrectionLoss, SurvivesAFlatComponent) {
  MixtureCorrection correction(kStandard);
  for (const double large : {1e2, 1e3, 1.1e5}) {
    for (const double small : {1e-3, 1.3e-3, 1e-9}) {
      GaussianMixture q = random_mixture(2, 3, 1);
      q.precision_factors[1] << large, large, 0.0, 0.0, small, 0.0, 0.0, 0.0, 1.0;
      GaussianMixtureGradient gradient;
      const double log_z = correction.log_normalizer(q, &gradient);
      // Rounding can make the singular pivot too large by some 10^-16 large^2, and the flat
      // component's mass too small. The sound one's is all there.
      EXPECT_GE(log_z, q.log_weights(0) - 1e-6) << large << " " << small;
      EXPECT_LE(log_z, 1e-2) << large << " " << small;
      EXPECT_TRUE(gradient.log_weights.allFinite());
      for (const std::size_t k : {0u, 1u}) {
        EXPECT_TRUE(gradient.means[k].allFinite()) << k;
        EXPECT_TRUE(gradient.precision_factors[k].allFinite()) << k;
      }
    }
  }
}

}  // namespace
}  // namespace npdr::inference
