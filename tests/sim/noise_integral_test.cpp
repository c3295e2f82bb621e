#include "sim/noise_integral.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace npdr::sim {
namespace {

// Precision and mean of a Gaussian whose parameters depend on each other.
Eigen::MatrixXd precision_of(Index k) {
  Eigen::MatrixXd precision = Eigen::MatrixXd::Constant(k, k, 0.5);
  precision.diagonal().setConstant(3.0);
  return precision;
}

// Both rules, quadrature and Laplace's, are exact for Gaussians.
TEST(NoiseIntegral, OfAGaussianIsExactInAnyDimension) {
  for (Index k = 1; k <= 6; ++k) {
    const Eigen::MatrixXd precision = precision_of(k);
    const Vector mean = Vector::LinSpaced(k, -1.0, 2.0);
    const LogIntegrand f = [&](const Vector& z) {
      return 1.5 - 0.5 * (z - mean).dot(precision * (z - mean));
    };
    const double expected = 1.5 + 0.5 * static_cast<double>(k) * std::log(2.0 * std::numbers::pi) -
                            0.5 * std::log(precision.determinant());
    EXPECT_NEAR(log_integral(f, Vector::Zero(k)), expected, 1e-5) << k;
    EXPECT_LT((find_peak(f, Vector::Zero(k)).mode - mean).cwiseAbs().maxCoeff(), 1e-4) << k;
  }
}

// exp(-n z - exp(-2 z) n / 2), of the log of a scale: its integral is Gamma(n / 2) (2 / n)^(n / 2)
// / 2. Of n = 40 errors Laplace's rule, here of each of four scales, is 1 / 6n off.
TEST(NoiseIntegral, OfScalesIsNearGammaFunctions) {
  constexpr double n = 40.0;
  const double one = std::lgamma(0.5 * n) + 0.5 * n * std::log(2.0 / n) - std::log(2.0);
  const LogIntegrand f = [&](const Vector& z) {
    return -n * z.sum() - 0.5 * n * (-2.0 * z.array()).exp().sum();
  };
  EXPECT_NEAR(log_integral(f, Vector::Constant(1, 0.5)), one, 1e-4);
  EXPECT_NEAR(log_integral(f, Vector::Constant(4, 0.5)), 4.0 * one, 4.0 / (6.0 * n) + 0.01);
}

// Half of a Gaussian, and a quarter, whose modes are at their ends.
TEST(NoiseIntegral, OfWhatEndsBesideItsModeIsThePartThatIsLeft) {
  for (const double end : {0.01, 0.0009, 0.0005, 0.0}) {
    for (const Index k : {1, 2}) {
      const LogIntegrand f = [&](const Vector& z) {
        return z.maxCoeff() > end ? -HUGE_VAL : -0.5 * z.squaredNorm();
      };
      const double part =
          std::log(std::sqrt(2.0 * std::numbers::pi) * 0.5 * std::erfc(-end / std::numbers::sqrt2));
      EXPECT_NEAR(log_integral(f, Vector::Zero(k)), static_cast<double>(k) * part, 0.2)
          << end << " of " << k;
    }
  }
}

TEST(NoiseIntegral, OfNoParametersIsTheValue) {
  EXPECT_EQ(log_integral([](const Vector&) { return -3.0; }, Vector()), -3.0);
}

TEST(NoiseIntegral, OfNothingIsZero) {
  const LogIntegrand nothing = [](const Vector&) { return -HUGE_VAL; };
  EXPECT_EQ(log_integral(nothing, Vector::Zero(2)), -HUGE_VAL);
}

}  // namespace
}  // namespace npdr::sim
