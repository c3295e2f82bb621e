#include "inference/kernel_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

double normal_pdf(double x, double mean, double variance) {
  return std::exp(-0.5 * (x - mean) * (x - mean) / variance) /
         std::sqrt(2.0 * std::numbers::pi * variance);
}

// Weights 1/2, 1/4, 1/4 at 0, 1, 3: mean 1, sum w (x - 1)^2 = 3/2, 1 - sum w^2 = 5/8, so that the
// variance is 12/5; effective size 8/3.
TEST(KernelDensity, IsScottsRuleOnTheWeightedVariance) {
  const RowMatrix points = Eigen::Vector3d(0.0, 1.0, 3.0);
  const Vector weights = Eigen::Vector3d(2.0, 1.0, 1.0);
  EXPECT_NEAR(effective_size(weights), 8.0 / 3.0, 1e-14);
  EXPECT_NEAR(weighted_covariance(points, weights)(0, 0), 2.4, 1e-14);
  const double variance = std::pow(8.0 / 3.0, -0.4) * 2.4;
  const double x = 0.7;
  const double expected = 0.5 * normal_pdf(x, 0.0, variance) + 0.25 * normal_pdf(x, 1.0, variance) +
                          0.25 * normal_pdf(x, 3.0, variance);
  EXPECT_NEAR(KernelDensity(points, weights).log_prob(RowMatrix::Constant(1, 1, x))(0),
              std::log(expected), 1e-8);
}

RowMatrix normal_points(Index n, Index d) {
  RowMatrix points(n, d);
  for (Index i = 0; i < n; ++i) {
    Stream stream({1, "points", 0, static_cast<std::uint64_t>(i), 0});
    for (double& value : points.row(i)) value = stream.normal();
  }
  return points;
}

TEST(KernelDensity, FollowsScalesAndCorrelations) {
  const RowMatrix points = normal_points(50, 2);
  Eigen::MatrixXd map(2, 2);
  map << 3.0, 0.0, 1.0, 0.1;
  const Vector weights = Vector::Ones(50);
  const KernelDensity plain(points, weights), mapped(points * map.transpose(), weights);
  const RowMatrix at = points.topRows(5).array() + 0.1;
  EXPECT_LT((mapped.log_prob(at * map.transpose()) -
             (plain.log_prob(at).array() - std::log(0.3)).matrix())
                .norm(),
            1e-6);
}

TEST(KernelDensity, LeavesOutWhatDoesNotVaryAndWhatIsNotFinite) {
  const RowMatrix points = normal_points(20, 1);
  RowMatrix wider = RowMatrix::Zero(21, 3);
  wider.col(0).head(20) = points.col(0);
  wider(20, 0) = kNaN;
  wider.col(1).setConstant(9.81);
  const Vector expected = KernelDensity(points, Vector::Ones(20)).log_prob(points);
  const Vector found = KernelDensity(wider, Vector::Ones(21)).log_prob(wider);
  EXPECT_EQ(found.head(20), expected);
  EXPECT_EQ(found(20), -kInfinity);
  EXPECT_THROW(KernelDensity(RowMatrix::Ones(5, 2), Vector::Ones(5)), InputError);
}

// The variance of n = 20,000 steps has a relative standard error of 1 %; 5 of them are exceeded
// once in 10^6.
TEST(KernelDensity, StepsHaveTheKernelsCovariance) {
  RowMatrix points = normal_points(100, 2);
  points.col(1) *= 10.0;
  const KernelDensity density(points, Vector::Ones(100));
  const Eigen::MatrixXd expected =
      std::pow(100.0, -2.0 / 6.0) * weighted_covariance(points, Vector::Ones(100));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2, 2);
  constexpr Index n = 20'000;
  for (Index i = 0; i < n; ++i) {
    Stream stream({1, "steps", 0, static_cast<std::uint64_t>(i), 0});
    const Vector step = density.sample_kernel(stream);
    covariance += step * step.transpose() / double(n);
  }
  EXPECT_NEAR(covariance(0, 0) / expected(0, 0), 1.0, 0.05);
  EXPECT_NEAR(covariance(1, 1) / expected(1, 1), 1.0, 0.05);
}

}  // namespace
}  // namespace npdr::inference
