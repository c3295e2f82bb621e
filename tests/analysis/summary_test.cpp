#include "analysis/summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace npdr::analysis {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Mean (1 + 2 + 6) / 3 = 3; squares 4 + 1 + 9 = 14 over n - 1 = 2.
TEST(Summary, CountsFailuresAndLeavesThemOut) {
  Vector values(5);
  values << 1, kNaN, 2, std::numeric_limits<double>::infinity(), 6;
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

}  // namespace
}  // namespace npdr::analysis
