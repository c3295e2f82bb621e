#include "inference/estimators/spline_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

using Columns = ColumnMatrixX<double>;

constexpr Index kRows = 40, kVariables = 3, kBins = 6;

ElementScratch<double> scratch_of(const SplineMap<double>& map, double size) {
  ElementScratch<double> scratch;
  scratch.raw = size * random_matrix(kRows, map.num_parameters() * kVariables, 1);
  return scratch;
}

Columns map_of(const SplineMap<double>& map, const Columns& u, double size, Vector& log_det) {
  ElementScratch<double> scratch = scratch_of(map, size);
  Columns z;
  log_det = Vector::Zero(kRows);
  map.forward(u, scratch, z, log_det);
  return z;
}

TEST(SplineMap, IsTheIdentityWhereTheNetworkSaysNothing) {
  const SplineMap<double> map(kBins);
  const Columns u = 3.0 * random_matrix(kRows, kVariables, 2);
  Vector log_det;
  EXPECT_TRUE(map_of(map, u, 0.0, log_det).isApprox(u, 1e-12));
  EXPECT_LT(log_det.cwiseAbs().maxCoeff(), 1e-12);
}

// Central differences of z by u, inside, outside and at the ends of the spline.
TEST(SplineMap, LogDeterminantIsThatOfItsDerivative) {
  const SplineMap<double> map(kBins);
  const Columns u = 3.0 * random_matrix(kRows, kVariables, 3);
  Vector log_det, unused;
  map_of(map, u, 1.0, log_det);
  const double step = 1e-6;
  const Columns slope =
      (map_of(map, u.array() + step, 1.0, unused) - map_of(map, u.array() - step, 1.0, unused)) /
      (2.0 * step);
  EXPECT_GT(slope.minCoeff(), 0.0);
  EXPECT_LT((slope.array().log().matrix().rowwise().sum() - log_det).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(SplineMap, InverseUndoesForward) {
  const SplineMap<double> map(kBins);
  const Columns u = 4.0 * random_matrix(kRows, kVariables, 4);
  for (const double size : {0.1, 1.0, 4.0}) {
    Vector log_det;
    const Columns z = map_of(map, u, size, log_det);
    const Columns raw = scratch_of(map, size).raw;
    for (Index d = 0; d < kVariables; ++d) {
      Columns own(kRows, map.num_parameters());
      for (Index p = 0; p < own.cols(); ++p) own.col(p) = raw.col(p * kVariables + d);
      EXPECT_LT((map.inverse(z.col(d), own) - u.col(d)).cwiseAbs().maxCoeff(), 1e-7) << size;
    }
  }
}

// d/draw and d/du of sum w z + sum v log_det.
TEST(SplineMap, BackwardPassEqualsCentralDifferences) {
  const SplineMap<double> map(kBins);
  const Columns u = 3.0 * random_matrix(kRows, kVariables, 5);
  const Columns weights = random_matrix(kRows, kVariables, 6);
  const Vector det_weights = random_matrix(kRows, 1, 7).col(0);
  const auto objective = [&](const Columns& input, const Columns& raw) {
    ElementScratch<double> scratch;
    scratch.raw = raw;
    Columns z;
    Vector log_det = Vector::Zero(kRows);
    map.forward(input, scratch, z, log_det);
    return weights.cwiseProduct(z).sum() + det_weights.dot(log_det);
  };
  ElementScratch<double> scratch = scratch_of(map, 1.0);
  const Columns raw = scratch.raw;
  Columns z;
  Vector log_det = Vector::Zero(kRows);
  map.forward(u, scratch, z, log_det);
  Columns d = weights;
  map.backward(u, det_weights, scratch, d);
  const auto flat = [](const Columns& m) -> Vector {
    return Eigen::Map<const Vector>(m.data(), m.size());
  };
  expect_gradient(
      [&](const Vector& r) {
        return objective(u, Eigen::Map<const Columns>(r.data(), raw.rows(), raw.cols()));
      },
      flat(raw), flat(scratch.d_raw));
  expect_gradient(
      [&](const Vector& x) {
        return objective(Eigen::Map<const Columns>(x.data(), u.rows(), u.cols()), raw);
      },
      flat(u), flat(d));
}

TEST(SplineMap, RejectsNumbersOfBinsThatCannotBe) {
  EXPECT_THROW(SplineMap<float>(1), InputError);
  EXPECT_THROW(SplineMap<float>(101), InputError);
}

}  // namespace
}  // namespace npdr::inference
