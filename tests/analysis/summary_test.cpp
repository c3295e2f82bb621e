// Summaries and densities of samples.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/density_curve.h"
#include "analysis/feature_comparison.h"
#include "analysis/summary.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

// Mean (1 + 2 + 6) / 3 = 3; squares 4 + 1 + 9 = 14 over n - 1 = 2.
TEST(Summary, CountsFailuresAndLeavesThemOut) {
  Vector values(5);
  values << 1, kNaN, 2, kInfinity, 6;
  const Summary summary = summarize(values);
  EXPECT_DOUBLE_EQ(summary.mean, 3.0);
  EXPECT_DOUBLE_EQ(summary.std, std::sqrt(7.0));
  EXPECT_EQ(summary.n, 3);
  EXPECT_EQ(summary.n_failed, 2);
}

TEST(Summary, OfTooFewValuesIsNan) {
  const Summary one = summarize(Vector::Constant(1, 5.0));
  EXPECT_EQ(one.mean, 5.0);
  EXPECT_TRUE(std::isnan(one.std));
  const Summary none = summarize(Vector::Constant(2, kNaN));
  EXPECT_TRUE(std::isnan(none.mean));
  EXPECT_TRUE(std::isnan(none.std));
  EXPECT_EQ(none.n, 0);
  EXPECT_EQ(none.n_failed, 2);
}

TEST(SummarizePeriodic, SeesThatBothEndsOfAPeriodAreOne) {
  constexpr double pi = 3.14159265358979323846;
  Vector values(4);
  values << pi / 2 - 0.1, -pi / 2 + 0.1, pi / 2 - 0.1, -pi / 2 + 0.1;
  const Summary summary = summarize_periodic(values, pi);
  EXPECT_NEAR(std::abs(summary.mean), pi / 2, 1e-12);
  EXPECT_NEAR(summary.std, 0.1 * std::sqrt(4.0 / 3.0), 1e-12);
  EXPECT_EQ(summary.n, 4);
}

// 7 at -1.3 and 3 at 0: the mean of their directions, and the deviation around it.
TEST(SummarizePeriodic, IsTheCircularMeanOfASkewedSet) {
  constexpr double pi = 3.14159265358979323846;
  Vector values = Vector::Constant(10, -1.3);
  values.tail(3).setZero();
  const double mean = 0.5 * std::atan2(7.0 * std::sin(-2.6), 7.0 * std::cos(-2.6) + 3.0);
  const Summary summary = summarize_periodic(values, pi);
  EXPECT_NEAR(summary.mean, mean, 1e-12);
  EXPECT_NEAR(summary.std, std::sqrt((7.0 * std::pow(-1.3 - mean, 2) + 3.0 * mean * mean) / 9.0),
              1e-12);
}

TEST(SummarizePeriodic, IsSummarizeForANarrowSetAndWithoutAPeriod) {
  Vector values(3);
  values << 0.1, 0.2, 0.3;
  const Summary plain = summarize(values);
  const Summary periodic = summarize_periodic(values, 3.0);
  EXPECT_NEAR(periodic.mean, plain.mean, 1e-3);  // a circular mean weighs a little differently
  EXPECT_NEAR(periodic.std, plain.std, 1e-5);
  EXPECT_EQ(summarize_periodic(values, 0.0).mean, plain.mean);
}

TEST(SummarizePeriodic, LiesInThePeriodAroundTheCenter) {
  constexpr double pi = 3.14159265358979323846;
  const Vector values{{2.8, 2.9, 3.0}};
  for (const auto& [center, mean] :
       {std::pair{0.0, 2.9 - pi}, {0.5 * pi, 2.9}, {20.0, 2.9 + 5.0 * pi}}) {
    EXPECT_NEAR(summarize_periodic(values, pi, center).mean, mean, 1e-12);
    EXPECT_NEAR(summarize_periodic(values, pi, center).std, 0.1, 1e-12);
  }
  const Vector shifted{{2.8 + pi, 2.9 - 2.0 * pi, 3.0}};
  EXPECT_NEAR(summarize_periodic(shifted, pi).mean, 2.9 - pi, 1e-12);
  EXPECT_NEAR(summarize_periodic(shifted, pi).std, 0.1, 1e-12);
}

TEST(FeaturePrediction, SummarizesTheFiniteValues) {
  Vector values(6);
  values << 4, 1, 3, 2, 5, kNaN;
  const FeaturePrediction prediction = predict_feature(values, 2.0);
  EXPECT_DOUBLE_EQ(prediction.summary.mean, 3.0);
  EXPECT_EQ(prediction.summary.n_failed, 1);
  EXPECT_DOUBLE_EQ(prediction.quantiles[1], 3.0);
  EXPECT_DOUBLE_EQ(prediction.quantiles[0], 1.2);
  // One of five lies below, one at x_o.
  EXPECT_DOUBLE_EQ(prediction.tail, 0.3);
  EXPECT_EQ(predict_feature(values, 10.0).tail, 1.0);
}

// By the trapezoidal rule, which is exact for the total mass of reflected kernels but for their
// shape between the points.
double integral(const RowMatrix& curve) {
  double sum = 0.0;
  for (Index k = 0; k + 1 < curve.rows(); ++k) {
    sum += 0.5 * (curve(k, 1) + curve(k + 1, 1)) * (curve(k + 1, 0) - curve(k, 0));
  }
  return sum;
}

template <typename Draw>
Vector samples(Index n, const Draw& draw) {
  Stream stream({1, "kernel_density_test"});
  Vector values(n);
  for (double& v : values) v = draw(stream);
  return values;
}

TEST(DensityCurve, IntegratesToOne) {
  const Vector narrow = samples(500, [](Stream& s) { return 3.0 + 1e-3 * s.normal(); });
  EXPECT_NEAR(integral(density_curve(narrow, 0.0, 10.0)), 1.0, 1e-3);
  const Vector wide = samples(500, [](Stream& s) { return s.uniform(); });
  EXPECT_NEAR(integral(density_curve(wide, 0.0, 1.0)), 1.0, 1e-3);
  Vector outside = samples(1000, [](Stream& s) { return 0.5 + 0.05 * s.normal(); });
  outside.head(250).array() += 5.0;
  EXPECT_NEAR(integral(density_curve(outside, 0.0, 1.0)), 0.75, 5e-3);
}

// Bias h^2 phi''(0) / 2 and standard error sqrt(phi(0) / (2 sqrt(pi) n h)) are both under 0.01
// here.
TEST(DensityCurve, ApproachesTheDensityOfTheSamples) {
  const Vector normal = samples(20'000, [](Stream& s) { return s.normal(); });
  const RowMatrix curve = density_curve(normal, -5.0, 5.0, 201);
  for (const Index k : {60, 100, 120}) {
    const double x = curve(k, 0);
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    EXPECT_NEAR(curve(k, 1), density, 0.02) << x;
  }
}

TEST(DensityCurve, DoesNotSagAtTheEnds) {
  const Vector uniform = samples(20'000, [](Stream& s) { return 2.0 * s.uniform(); });
  const RowMatrix curve = density_curve(uniform, 0.0, 2.0);
  EXPECT_NEAR(curve(0, 1), 0.5, 0.08);
  EXPECT_NEAR(curve(curve.rows() - 1, 1), 0.5, 0.08);
}

// One sample: its bandwidth is one spacing, the peak 1 / (spacing sqrt(2 pi)).
TEST(DensityCurve, OfOneSampleIsOneKernel) {
  const RowMatrix curve = density_curve(Vector::Constant(1, 0.5), 0.0, 1.0, 101);
  EXPECT_NEAR(curve(50, 1), 100.0 / std::sqrt(2.0 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(curve(51, 1) / curve(50, 1), std::exp(-0.5), 1e-9);
}

TEST(DensityCurve, IsZeroWithoutSamplesNearTheRange) {
  const Vector far = samples(1000, [](Stream& s) { return 1e30 * s.normal(); });
  EXPECT_LT(density_curve(far, 0.0, 1.0).col(1).maxCoeff(), 1e-3);
  for (const Vector& none :
       {Vector(Vector::Constant(3, kNaN)), Vector(), Vector(Vector::Constant(3, 7.0))}) {
    EXPECT_EQ(density_curve(none, 0.0, 1.0).col(1).maxCoeff(), 0.0);
  }
  EXPECT_THROW(density_curve(Vector::Zero(1), 1.0, 0.0), InputError);
  EXPECT_THROW(density_curve(Vector::Zero(1), 0.0, 1.0, 1), InputError);
}

}  // namespace
}  // namespace npdr::analysis
