#include "inference/abc/feature_distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "inference/matrix_features.h"
#include "tests/inference/tasks.h"

namespace npdr::inference {
namespace {

// 200 rows, so that there is a whole block, and one that isn't.
RowMatrixF features() {
  RowMatrixF x(200, 3);
  for (Index i = 0; i < x.rows(); ++i) {
    Stream stream({1, "features", 0, static_cast<std::uint64_t>(i), 0});
    x(i, 0) = static_cast<float>(stream.normal());
    x(i, 1) = static_cast<float>(100.0 + 50.0 * stream.normal());
    x(i, 2) = 7.0f;
  }
  return x;
}

TEST(FeatureDistance, CountsEveryFeatureInItsDeviations) {
  const RowMatrixF x = features();
  const MatrixFeatures source(x);
  const FeatureTransform transform = fit_feature_transform(source, 0);
  VectorF x_o(3);
  x_o << 0.5f, 80.0f, 7000.0f;  // the last one doesn't vary: it tells nothing
  const Vector distances = feature_distances(source, transform, x_o);
  const auto deviation = [&](Index f) {
    const Vector column = x.col(f).cast<double>();
    return std::sqrt((column.array() - column.mean()).square().mean());
  };
  for (const Index i : {0, 63, 64, 199}) {
    const double expected =
        std::hypot((x(i, 0) - 0.5) / deviation(0), (x(i, 1) - 80.0) / deviation(1));
    EXPECT_NEAR(distances(i), expected, 1e-5) << i;
  }
}

// One row in twenty does something, and so does the observation: what is far beyond the usual.
TEST(FeatureDistance, TellsNearFromFarAlsoWhereFewRowsAre) {
  RowMatrixF x(200, 1);
  for (Index i = 0; i < x.rows(); ++i) {
    x(i, 0) = i % 25 == 0 ? static_cast<float>(i) : 1e-4f * static_cast<float>(i % 7);
  }
  const MatrixFeatures source(x);
  const Vector distances =
      feature_distances(source, fit_feature_transform(source, 0), VectorF::Constant(1, 101.0f));
  Index nearest = 0;
  distances.minCoeff(&nearest);
  EXPECT_EQ(nearest, 100);
  EXPECT_NEAR(distances(125) / distances(100), 24.0, 1e-3);
}

TEST(FeatureDistance, OnAverageIsThatOfFeaturesThatVary) {
  const RowMatrixF x = features();
  const MatrixFeatures source(x);
  const FeatureTransform transform = fit_feature_transform(source, 0);
  RowMatrixF rows = x.topRows(3);
  rows(1, 2) = kFloatNaN;  // in a feature that doesn't count, but the row failed
  const VectorF x_o = x.row(9).transpose();
  const Vector mean = mean_feature_distances(rows, transform, x_o);
  const Vector norm = feature_distances(source, transform, x_o);
  EXPECT_DOUBLE_EQ(mean(0), norm(0) / std::sqrt(2.0));
  EXPECT_TRUE(std::isnan(mean(1)));
  EXPECT_DOUBLE_EQ(mean(2), norm(2) / std::sqrt(2.0));
  const RowMatrixF same = RowMatrixF::Ones(200, 3);
  const FeatureTransform of_same = fit_feature_transform(MatrixFeatures(same), 0);
  EXPECT_TRUE(std::isnan(mean_feature_distances(same, of_same, VectorF::Zero(3))(0)));
}

// Values of e^(3 u), u normal: their deviation is some 90, of which 0.01 and 1 are nothing.
TEST(FeatureDistance, WithoutTailsTellsSmallValuesApart) {
  RowMatrixF x(400, 1);
  for (Index i = 0; i < x.rows(); ++i) {
    Stream stream({1, "decades", 0, static_cast<std::uint64_t>(i), 0});
    x(i, 0) = static_cast<float>(std::exp(3.0 * stream.normal()));
  }
  const auto distance = [&](Tails tails) {
    const FeatureTransform transform = fit_feature_transform(MatrixFeatures(x), 0, tails);
    return mean_feature_distances(RowMatrixF::Constant(1, 1, 0.01f), transform,
                                  VectorF::Ones(1))(0);
  };
  EXPECT_LT(distance(Tails::kept), 0.1);
  EXPECT_GT(distance(Tails::compressed), 0.5);
}

TEST(FeatureDistance, RejectsAnotherNumberOfFeatures) {
  const RowMatrixF x = features();
  const MatrixFeatures source(x);
  const FeatureTransform transform = fit_feature_transform(source, 0);
  EXPECT_THROW(feature_distances(source, transform, VectorF::Zero(2)), ShapeError);
}

}  // namespace
}  // namespace npdr::inference
