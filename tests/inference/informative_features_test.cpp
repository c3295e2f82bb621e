#include "inference/informative_features.h"

#include <gtest/gtest.h>

#include "inference/matrix_features.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

// Of sixty features one moves with u_1, one with u_2^2, one has a spread that grows with u_1; the
// others are noise, of which every third has tails so heavy that it has no variance. 57 of them by
// eight correlations: a false-alarm rate of 3e-4.
TEST(InformativeFeatures, AreThoseThatDependOnTheta) {
  const Index n = 1000;
  const RowMatrix u = random_matrix(n, 2, 1);
  RowMatrix x = random_matrix(n, 60, 2);
  for (Index j = 3; j < 60; j += 3) {
    x.col(j) = x.col(j).array() / random_matrix(n, 1, 3 + j).array();
  }
  x.col(10) += u.col(0);
  x.col(20) += 0.7 * u.col(1).cwiseAbs2();
  x.col(31) = x.col(31).array() * (0.5 * u.col(0).array()).exp();
  const RowMatrixF features = x.cast<float>();
  const MatrixFeatures source(features);
  const FeatureTransform transform = fit_feature_transform(source, 0);
  EXPECT_EQ(informative_features(source, transform, u), (std::vector<Index>{10, 20, 31}));
  // The rows of x that u hasn't are not looked at.
  EXPECT_EQ(informative_features(source, transform, u.topRows(900)),
            (std::vector<Index>{10, 20, 31}));
}

TEST(InformativeFeatures, AConstantTellsNothing) {
  const RowMatrix u = random_matrix(100, 1, 1);
  RowMatrixF features = RowMatrixF::Constant(100, 3, 0.1F);
  features.col(1) = u.col(0).cast<float>();
  const MatrixFeatures source(features);
  EXPECT_EQ(informative_features(source, fit_feature_transform(source, 0), u),
            (std::vector<Index>{1}));
}

}  // namespace
}  // namespace npdr::inference
