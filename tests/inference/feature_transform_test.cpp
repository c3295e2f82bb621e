#include "inference/feature_transform.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "inference/matrix_features.h"
#include "tests/inference/gradient_check.h"
#include "tests/inference/tasks.h"

namespace npdr::inference {
namespace {

TEST(FeatureTransform, StandardizationGivesMeanZeroAndDeviationOne) {
  RowMatrixF x(5, 2);
  x << 1, 10, 2, 30, 3, 20, 4, 50, 5, 40;
  RowMatrixF z;
  fit_feature_transform(MatrixFeatures(x), 0).apply(x, z);
  EXPECT_TRUE(z.colwise().mean().isZero(1e-6f));
  EXPECT_TRUE((z.colwise().squaredNorm() / 5.0f).isOnes(1e-5f));
}

TEST(FeatureTransform, AFewSimulationsThatAllButDivergedDontSetTheScale) {
  RowMatrixF x = random_matrix(1000, 3, 1).cast<float>();
  RowMatrixF usual, with_outliers;
  fit_feature_transform(MatrixFeatures(x), 0).apply(x, usual);
  for (const Index row : {3, 700}) x.row(row) *= 1e6f;
  fit_feature_transform(MatrixFeatures(x), 0).apply(x, with_outliers);
  // Two of 1000 rows at the bounds, about 70 deviations away, widen the deviation threefold.
  EXPECT_GT(with_outliers.row(0).norm(), 0.2f * usual.row(0).norm());
  // A million deviations, three times as wide.
  EXPECT_NEAR(with_outliers.cwiseAbs().maxCoeff(), 100.0f + std::log(1e6f / 300.0f), 2.0f);
}

// Nor where nearly all simulations share a value, and what the others have tells something.
TEST(FeatureTransform, OneThatDivergedDoesntHideWhatFewOthersHave) {
  RowMatrixF x = RowMatrixF::Zero(1000, 1);
  for (Index i = 0; i < 1000; i += 25) x(i, 0) = static_cast<float>(1 + i % 4);
  for (const float outlier : {1e12f, -1e12f}) {
    x(101, 0) = outlier;
    RowMatrixF z;
    fit_feature_transform(MatrixFeatures(x), 0).apply(x, z);
    EXPECT_GT(z(25, 0) - z(0, 0), 0.05f);
    EXPECT_GT(outlier * z(101, 0), 0.0f);
  }
}

// What few simulations have can be told apart, however far from all others.
TEST(FeatureTransform, WhatLiesFarOutKeepsItsOrder) {
  RowMatrixF x = random_matrix(1000, 1, 1).cast<float>();
  x.topRows(3) << 1e4f, 1e6f, -1e36f;
  RowMatrixF z;
  fit_feature_transform(MatrixFeatures(x), 0).apply(x, z);
  EXPECT_GT(z(0, 0), 100.0f);
  EXPECT_NEAR(z(1, 0) - z(0, 0), std::log(100.0f), 1e-3f);
  EXPECT_LT(z(2, 0), -150.0f);
  EXPECT_TRUE(z.allFinite());
}

// Equal but for rounding in nearly all simulations: the others tell something.
TEST(FeatureTransform, RoundingIsNoScale) {
  RowMatrixF x = RowMatrixF::Ones(1000, 1);
  for (Index i = 0; i < 1000; i += 3) x(i, 0) -= 1.2e-7f;
  x.topRows(30) = 0.5f * RowMatrixF::Ones(30, 1) + 0.1f * random_matrix(30, 1, 1).cast<float>();
  RowMatrixF z;
  for (const Tails tails : {Tails::kept, Tails::compressed}) {
    fit_feature_transform(MatrixFeatures(x), 0, tails).apply(x, z);
    EXPECT_GT(std::abs(z(0, 0) - z(1, 0)), 1e-2f);
    EXPECT_GT(std::abs(z(0, 0) - z(999, 0)), 1.0f);
  }
}

TEST(FeatureTransform, LeavesOutAConstantFeature) {
  RowMatrixF x(3, 2);
  x << 0.1f, 1, 0.1f, 2, 0.1f, 3;
  RowMatrixF z;
  fit_feature_transform(MatrixFeatures(x), 0).apply(x, z);
  EXPECT_TRUE(z.col(0).isZero());
  EXPECT_TRUE(z.allFinite());
}

// x = s A + small noise with s of rank 2: two components carry all of it, uncorrelated and of unit
// variance; with more features than rows (the route through z z^T) and with fewer.
TEST(FeatureTransform, ComponentsAreUncorrelatedAndOfUnitVariance) {
  for (const Index features : {8, 300}) {
    const RowMatrix source = random_matrix(200, 2, 1) * random_matrix(2, features, 2) +
                             0.01 * random_matrix(200, features, 3);
    const RowMatrixF x = source.cast<float>();
    RowMatrixF z;
    fit_feature_transform(MatrixFeatures(x), 2).apply(x, z);
    ASSERT_EQ(z.cols(), 2);
    EXPECT_TRUE((z.transpose() * z / 200.0f).isIdentity(1e-3f)) << z.transpose() * z / 200.0f;
  }
}

TEST(FeatureTransform, IsTheSameMapWhateverTheRouteToTheEigenvectors) {
  // 50 rows: with 40 features z^T z is smaller, with 60 z z^T; the shared 40 features decide both.
  RowMatrix source = random_matrix(50, 3, 1) * random_matrix(3, 60, 2);
  source.rightCols(20).setZero();
  const RowMatrixF wide = source.cast<float>();
  const RowMatrixF narrow = wide.leftCols(40);
  RowMatrixF z_wide, z_narrow;
  fit_feature_transform(MatrixFeatures(wide), 3).apply(wide, z_wide);
  fit_feature_transform(MatrixFeatures(narrow), 3).apply(narrow, z_narrow);
  EXPECT_TRUE(z_wide.cwiseAbs().isApprox(z_narrow.cwiseAbs(), 1e-3f));
}

TEST(FeatureTransform, HasNoMoreComponentsThanThereAreDirections) {
  const RowMatrixF x = random_matrix(20, 5, 1).cast<float>();
  EXPECT_EQ(fit_feature_transform(MatrixFeatures(x), 6).num_outputs(), 5);
  EXPECT_EQ(fit_feature_transform(MatrixFeatures(x.topRows(3)), 6).num_outputs(), 3);
  const RowMatrixF constant = RowMatrixF::Ones(20, 5);
  RowMatrixF z;
  fit_feature_transform(MatrixFeatures(constant), 6).apply(constant, z);
  EXPECT_TRUE(z.isZero(0.0f)) << "what doesn't vary carries nothing";
}

TEST(FeatureTransform, VaryingOutputsAreThoseThatSomeSimulationsDifferIn) {
  RowMatrixF x(4, 3), all, z;
  x << 1, 5, 2, 2, 5, 1, 3, 5, 5, 4, 5, 0;
  const FeatureTransform transform = fit_feature_transform(MatrixFeatures(x), 0);
  transform.apply(x, all);
  const MatrixFeatures source(x);
  varying_outputs(transform, source).apply(x, z);
  ASSERT_EQ(z.cols(), 2);
  EXPECT_EQ(z.col(0), all.col(0));
  EXPECT_EQ(z.col(1), all.col(2));
  EXPECT_EQ(varying_outputs(fit_feature_transform(source, 3), source).num_outputs(), 2);
  const RowMatrixF ones = RowMatrixF::Ones(4, 2);
  const MatrixFeatures constant(ones);
  EXPECT_THROW(varying_outputs(fit_feature_transform(constant, 0), constant), InputError);
}

TEST(FeatureTransform, VaryingOutputsArentNearlyConstantWhereOthersVaryMore) {
  RowMatrixF x = random_matrix(1000, 2, 1).cast<float>();
  x.col(1).setZero();
  x.col(1).head(9).setOnes();
  const MatrixFeatures source(x);
  const FeatureTransform transform = fit_feature_transform(source, 0);
  EXPECT_EQ(varying_outputs(transform, source).num_outputs(), 1);
  x.col(1).head(10).setOnes();
  EXPECT_EQ(varying_outputs(transform, source).num_outputs(), 2);
  x.col(1).head(9).setZero();
  x.col(0) = x.col(1);
  EXPECT_EQ(varying_outputs(transform, source).num_outputs(), 2) << "there is nothing else";
}

}  // namespace
}  // namespace npdr::inference
