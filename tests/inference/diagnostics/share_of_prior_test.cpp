#include "inference/diagnostics/share_of_prior.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace npdr::inference {
namespace {

const StreamId kId{1, "share", 0, 0, 0};

RowMatrix normal(Index n, Index dimension, std::uint64_t seed) {
  RowMatrix draws(n, dimension);
  Stream stream({seed, "test", 0, 0, 0});
  for (double& value : draws.reshaped()) value = stream.normal();
  return draws;
}

TEST(ShareOfPrior, OfThePriorItselfIsNearlyAll) {
  for (const Index dimension : {1, 5, 20}) {
    EXPECT_NEAR(share_of_prior(normal(2000, dimension, 1), kId), 0.99, 0.03) << dimension;
  }
}

// Deviations s around 0 in D dimensions: the ball of radius r s, which P(chi^2 <= r^2) = 0.99 sets,
// with phi(0) all over it: V_D (r s)^D / (2 pi)^(D/2). Of 4000 samples r is known to 0.7 % or so,
// and its powers to 5 and 10 %; weights of 10,000 draws add 3 %.
TEST(ShareOfPrior, OfNarrowPosteriorsIsTheirVolume) {
  for (const auto& [dimension, squared_radius] : {std::pair{5, 15.09}, std::pair{15, 30.58}}) {
    const double d = dimension, s = 0.02;
    const double log_volume = 0.5 * d * std::log(std::numbers::pi) - std::lgamma(0.5 * d + 1.0) +
                              d * std::log(s * std::sqrt(squared_radius));
    const double expected = log_volume - 0.5 * d * std::log(2.0 * std::numbers::pi);
    EXPECT_NEAR(std::log(share_of_prior(s * normal(4000, dimension, 2), kId)), expected, 0.4);
  }
}

// Of 1e6 draws of the prior, those in the ellipsoid of the samples.
double counted_share(const RowMatrix& samples) {
  const RowMatrix draws = normal(1'000'000, samples.cols(), 4);
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const RowMatrix centered = samples.rowwise() - mean;
  const Eigen::MatrixXd inverse =
      (centered.transpose() * centered / static_cast<double>(samples.rows())).inverse();
  const auto distances = [&](const RowMatrix& rows) -> Vector {
    const RowMatrix from_mean = rows.rowwise() - mean;
    return (from_mean * inverse).cwiseProduct(from_mean).rowwise().sum();
  };
  Vector own = distances(samples);
  std::sort(own.begin(), own.end());
  const double farthest = own(static_cast<Index>(0.99 * static_cast<double>(own.size() - 1)));
  return (distances(draws).array() <= farthest).cast<double>().mean();
}

// Off the middle, correlated; with tails as heavy as Student's t of 3 degrees of freedom; narrow,
// and 3 % as wide as the prior.
TEST(ShareOfPrior, IsWhatCountingFinds) {
  RowMatrix correlated = normal(1000, 2, 3);
  correlated.col(1) = 0.9 * correlated.col(0) + 0.2 * correlated.col(1);
  correlated = (0.3 * correlated).array() + 0.7;
  EXPECT_NEAR(share_of_prior(correlated, kId) / counted_share(correlated), 1.0, 0.05);
  RowMatrix heavy = 0.1 * normal(1000, 5, 5);
  const RowMatrix of_chi = normal(1000, 3, 6);
  for (Index i = 0; i < heavy.rows(); ++i) heavy.row(i) *= std::sqrt(3.0) / of_chi.row(i).norm();
  EXPECT_NEAR(share_of_prior(heavy, kId) / counted_share(heavy), 1.0, 0.1);
  RowMatrix mixture = 0.05 * normal(1000, 5, 7);
  mixture.topRows(30) *= 20.0;
  EXPECT_NEAR(share_of_prior(mixture, kId) / counted_share(mixture), 1.0, 0.1);
}

TEST(ShareOfPrior, OfSamplesThatDontVaryIsAll) {
  EXPECT_EQ(share_of_prior(RowMatrix::Ones(100, 2), kId), 1.0);
}

}  // namespace
}  // namespace npdr::inference
