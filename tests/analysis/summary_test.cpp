#include <gtest/gtest.h>

#include <cmath>

#include "analysis/feature_comparison.h"
#include "analysis/summary.h"
#include "core/constants.h"

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
  Vector values(3);
  values << 2.8, 2.9, 3.0;
  constexpr double pi = 3.14159265358979323846;
  EXPECT_NEAR(summarize_periodic(values, pi).mean, 2.9 - pi, 1e-12);
  EXPECT_NEAR(summarize_periodic(values, pi, 0.5 * pi).mean, 2.9, 1e-12);
  EXPECT_NEAR(summarize_periodic(values, pi, 20.0).mean, 2.9 + 5.0 * pi, 1e-12);
  EXPECT_NEAR(summarize_periodic(values, pi, 20.0).std, 0.1, 1e-12);
}

TEST(SummarizePeriodic, ShiftingByPeriodsChangesNothing) {
  Vector values(3), shifted(3);
  values << 0.1, 0.9, 1.4;
  shifted << 0.1 + 2.0, 0.9 - 4.0, 1.4;
  EXPECT_NEAR(summarize_periodic(values, 2.0).mean, summarize_periodic(shifted, 2.0).mean, 1e-12);
  EXPECT_NEAR(summarize_periodic(values, 2.0).std, summarize_periodic(shifted, 2.0).std, 1e-12);
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

}  // namespace
}  // namespace npdr::analysis
