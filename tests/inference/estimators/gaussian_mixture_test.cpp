#include "inference/estimators/gaussian_mixture.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "core/log_sum_exp.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

GaussianMixture two_components() {
  GaussianMixture mixture;
  mixture.log_weights = Vector(2);
  mixture.log_weights << std::log(0.3), std::log(0.7);
  mixture.means = {Vector::Constant(2, -1.0), Vector::Constant(2, 2.0)};
  Eigen::MatrixXd wide = Eigen::MatrixXd::Identity(2, 2) * 0.5;
  wide(0, 1) = 0.2;
  Eigen::MatrixXd narrow = Eigen::MatrixXd::Identity(2, 2) * 3.0;
  mixture.precision_factors = {wide, narrow};
  return mixture;
}

TEST(GaussianMixture, SamplesHaveTheMomentsOfTheMixture) {
  const GaussianMixture mixture = two_components();
  constexpr int n = 40'000;
  Vector sum = Vector::Zero(2);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(2, 2);
  const RowMatrix samples = mixture.sample(n, {1, "mixture", 0, 0, 0});
  for (const Vector u : samples.rowwise()) {
    sum += u;
    products += u * u.transpose();
  }
  Vector mean = Vector::Zero(2);
  Eigen::MatrixXd second = Eigen::MatrixXd::Zero(2, 2);
  for (Index k = 0; k < 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double weight = std::exp(mixture.log_weights(k));
    mean += weight * mixture.means[i];
    second +=
        weight * (mixture.precision(k).inverse() + mixture.means[i] * mixture.means[i].transpose());
  }
  // Five standard errors with a fourth moment below 60: false-alarm rate below 1e-5.
  EXPECT_TRUE((sum / n - mean).cwiseAbs().maxCoeff() < 5.0 * std::sqrt(6.0 / n));
  EXPECT_TRUE((products / n - second).cwiseAbs().maxCoeff() < 5.0 * std::sqrt(60.0 / n));
}

TEST(GaussianMixture, NarrowerThanPriorRaisesOnlyTheWideDirections) {
  const GaussianMixture narrow = narrower_than_prior(two_components());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> first(narrow.precision(0));
  EXPECT_GE(first.eigenvalues().minCoeff(), 1.0 - 1e-12);
  EXPECT_TRUE(narrow.precision(1).isApprox(two_components().precision(1), 1e-12));
}

GaussianMixture one_component(double mean, double factor) {
  return {Vector::Zero(1), {Vector::Constant(2, mean)}, {Eigen::MatrixXd::Identity(2, 2) * factor}};
}

TEST(GaussianMixture, DividedByTheProposalItIsProportionalToTheQuotient) {
  GaussianMixture mixture = two_components();
  mixture.precision_factors[0] *= 4.0;  // narrower than the proposal in every direction
  const GaussianMixture proposal = one_component(0.5, 0.8), prior = one_component(0.0, 1.0);
  const GaussianMixture corrected = corrected_for_proposal(mixture, proposal);
  RowMatrix u(40, 2);
  Stream stream({1, "points", 0, 0, 0});
  for (double& value : u.reshaped()) value = 2.0 * stream.normal();
  const Vector constant =
      corrected.log_prob(u) - mixture.log_prob(u) + proposal.log_prob(u) - prior.log_prob(u);
  EXPECT_LT((constant.array() - constant(0)).abs().maxCoeff(), 1e-9);
  EXPECT_NEAR(log_sum_exp(corrected.log_weights), 0.0, 1e-12);
}

TEST(GaussianMixture, DividedByANarrowerProposalThePriorIsLeft) {
  const GaussianMixture prior = one_component(0.0, 1.0);
  const GaussianMixture corrected =
      corrected_for_proposal(one_component(1.0, 0.5), one_component(-1.0, 0.8));
  EXPECT_LT(corrected.means[0].norm(), 1e-12);
  EXPECT_TRUE(corrected.precision(0).isApprox(prior.precision(0), 1e-12));
}

TEST(GaussianMixture, AComponentWiderThanTheProposalGainsNoWeight) {
  // The second component says what the proposal says, but for being wider: it counts as the prior,
  // with the weight that it has.
  GaussianMixture mixture = two_components();
  mixture.precision_factors[0] *= 4.0;
  const GaussianMixture proposal = one_component(0.5, 0.8);
  mixture.means[1] = proposal.means[0];
  mixture.precision_factors[1] = proposal.precision_factors[0];
  const GaussianMixture same = corrected_for_proposal(mixture, proposal);
  mixture.precision_factors[1] *= 0.9;
  const GaussianMixture wider = corrected_for_proposal(mixture, proposal);
  EXPECT_TRUE(wider.log_weights.isApprox(same.log_weights, 1e-9));
}

TEST(GaussianMixture, ComponentsNextToNothingDoNotCountInTheTailsOfTheProposal) {
  GaussianMixture mixture = two_components();
  mixture.log_weights << std::log(1e-9), std::log1p(-1e-9);
  mixture.precision_factors[0] *= 8.0;
  mixture.means = {Vector::Constant(2, -3.0), Vector::Zero(2)};
  const GaussianMixture corrected = corrected_for_proposal(mixture, one_component(0.0, 2.0));
  EXPECT_EQ(corrected.log_weights(1), 0.0);
  RowMatrix u(1, 2);
  u << -3.0, -3.0;
  EXPECT_LT(corrected.log_prob(u)(0), -50.0);
}

}  // namespace
}  // namespace npdr::inference
