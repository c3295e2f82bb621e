#include "inference/samplers/importance_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace npdr::inference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The second point is at 8 where 4 is the most, the third one where the density is 0.
TEST(HeavyShare, IsWhatLiesAboveTheMost) {
  const Vector weights{{1.0, 3.0, 0.5, 0.0}}, log_ratios{{0.0, std::log(8.0), kInfinity, kNan}};
  EXPECT_DOUBLE_EQ(heavy_share(weights, log_ratios, std::log(4.0)), (1.5 + 0.5) / 4.5);
  EXPECT_EQ(heavy_share(weights.head(2), log_ratios.head(2), std::log(8.0)), 0.0);
}

TEST(HeavyShare, OfNothingIsNoNumber) {
  EXPECT_TRUE(std::isnan(heavy_share(Vector::Zero(2), Vector::Zero(2), 0.0)));
}

}  // namespace
}  // namespace npdr::inference
