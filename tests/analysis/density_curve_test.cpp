#include "analysis/density_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

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

TEST(DensityCurve, SamplesOutsideLowerTheArea) {
  Vector values = samples(1000, [](Stream& s) { return 0.5 + 0.05 * s.normal(); });
  values.head(250).array() += 5.0;
  EXPECT_NEAR(integral(density_curve(values, 0.0, 1.0)), 0.75, 5e-3);
}

// One sample: its bandwidth is one spacing, the peak 1 / (spacing sqrt(2 pi)).
TEST(DensityCurve, OfOneSampleIsOneKernel) {
  const RowMatrix curve = density_curve(Vector::Constant(1, 0.5), 0.0, 1.0, 101);
  EXPECT_NEAR(curve(50, 1), 100.0 / std::sqrt(2.0 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(curve(51, 1) / curve(50, 1), std::exp(-0.5), 1e-9);
}

TEST(DensityCurve, EndsHoweverFarSamplesLieBeyondTheRange) {
  const Vector far = samples(1000, [](Stream& s) { return 1e30 * s.normal(); });
  EXPECT_LT(density_curve(far, 0.0, 1.0).col(1).maxCoeff(), 1e-3);
}

TEST(DensityCurve, IsZeroWithoutSamples) {
  const Vector unusable = Vector::Constant(3, kNaN);
  EXPECT_EQ(density_curve(unusable, 0.0, 1.0).col(1).maxCoeff(), 0.0);
  EXPECT_EQ(density_curve(Vector(), 0.0, 1.0).col(1).maxCoeff(), 0.0);
  EXPECT_EQ(density_curve(Vector::Constant(3, 7.0), 0.0, 1.0).col(1).maxCoeff(), 0.0);
}

TEST(DensityCurve, RejectsEmptyRanges) {
  EXPECT_THROW(density_curve(Vector::Zero(1), 1.0, 0.0), InputError);
  EXPECT_THROW(density_curve(Vector::Zero(1), 0.0, 1.0, 1), InputError);
}

}  // namespace
}  // namespace npdr::analysis
