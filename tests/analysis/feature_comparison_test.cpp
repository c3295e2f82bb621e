#include "analysis/feature_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/special_values.h"

namespace npdr::analysis {
namespace {

TEST(FeatureSpread, IsTheSampleStandardDeviation) {
  FeatureSpread spread(2);
  for (const float value : {1.0f, 2.0f, 4.0f, 5.0f}) {
    const float row[] = {value + 1e6f, 7.0f};
    spread.add(row);
  }
  // Mean 3, squares 4 + 1 + 1 + 4 over n - 1 = 3; far from 0 without a loss of digits.
  EXPECT_NEAR(spread.deviation()(0), std::sqrt(10.0 / 3.0), 1e-9);
  EXPECT_EQ(spread.deviation()(1), 0.0);
  EXPECT_EQ(FeatureSpread(1).deviation()(0), 0.0);
  const float wide[] = {1.0f, 2.0f, 3.0f};
  EXPECT_THROW(spread.add(wide), ShapeError);
}

TEST(FeatureDistance, IsTheRootMeanSquareInUnitsOfTheDeviation) {
  const RowMatrixF x = (RowMatrixF(2, 3) << 1, 2, 9, 3, kFloatNan, 0).finished();
  const Vector x_o = (Vector(3) << 0, 0, 0).finished();
  // The last feature doesn't vary: it isn't counted.
  const Vector deviation = (Vector(3) << 2, 1, 0).finished();
  const Vector distance = feature_distance(x, x_o, deviation);
  EXPECT_DOUBLE_EQ(distance(0), std::sqrt((0.25 + 4.0) / 2.0));
  EXPECT_TRUE(std::isnan(distance(1)));
  EXPECT_TRUE(std::isnan(feature_distance(x, x_o, Vector::Zero(3))(0)));
  EXPECT_THROW(feature_distance(x, x_o.head(2), deviation), ShapeError);
}

TEST(FeaturePrediction, SummarizesTheFiniteValues) {
  Vector values(6);
  values << 4, 1, 3, 2, 5, std::numeric_limits<double>::quiet_NaN();
  const FeaturePrediction prediction = predict_feature(values, 2.0);
  EXPECT_DOUBLE_EQ(prediction.summary.mean, 3.0);
  EXPECT_EQ(prediction.summary.n_failed, 1);
  EXPECT_DOUBLE_EQ(prediction.quantiles[1], 3.0);
  EXPECT_DOUBLE_EQ(prediction.quantiles[0], 1.2);
  // One of five lies below, one at x_o.
  EXPECT_DOUBLE_EQ(prediction.tail, 0.3);
  EXPECT_EQ(predict_feature(values, 10.0).tail, 1.0);
}

}  // namespace
}  // namespace npdr::analysis
