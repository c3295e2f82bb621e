#include "core/quantile.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/types.h"

namespace npdr {
namespace {

TEST(Quantile, IsLinearBetweenOrderStatistics) {
  const std::vector<double> values = {1.0, 2.0, 4.0, 8.0};
  EXPECT_EQ(quantile_of_sorted(values, 0.0), 1.0);
  EXPECT_EQ(quantile_of_sorted(values, 1.0), 8.0);
  EXPECT_DOUBLE_EQ(quantile_of_sorted(values, 0.5), 3.0);    // place 1.5
  EXPECT_DOUBLE_EQ(quantile_of_sorted(values, 0.25), 1.75);  // place 0.75
  EXPECT_TRUE(std::isnan(quantile_of_sorted(std::vector<double>(), 0.5)));
}

TEST(Quantile, IsAValueOfTheSampleWhereThatIsAsked) {
  const Vector values{{8.0, 1.0, 4.0, 2.0}};
  EXPECT_EQ(quantile(values, 0.5, Between::lower), 2.0);
  EXPECT_EQ(quantile(values, 0.99, Between::lower), 4.0);
  EXPECT_EQ(upper_median(values), 4.0);
  EXPECT_EQ(upper_median(std::vector<float>{3.0f, 1.0f, 2.0f}), 2.0f);
}

TEST(Quantile, OfFiniteValues) {
  EXPECT_EQ(sorted_finite(Vector{{2.0, kNaN, 1.0, -kInfinity}}), (std::vector{1.0, 2.0}));
}

}  // namespace
}  // namespace npdr
