#include "analysis/feature_comparison.h"

#include <gtest/gtest.h>

#include "core/constants.h"

namespace npdr::analysis {
namespace {

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

}  // namespace
}  // namespace npdr::analysis
