#include "pipeline/sources/repeated_outlier.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/random.h"
#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

class RepeatedOutliers : public testing::Test {
 protected:
  // 64 rows of two standard normal columns.
  RepeatedOutliers() : x_(64, 2) {
    Stream stream({1, "test", 0, 0, 0});
    for (double& value : x_.reshaped()) value = stream.normal();
  }

  std::string found() const { return repeated_outliers(x_, {{"total", "1"}, {"peak", "m"}}); }

  RowMatrix x_;
};

TEST_F(RepeatedOutliers, AreNamedWithTheirNumber) {
  x_(3, 1) = x_(40, 1) = x_(41, 1) = -999.0;
  EXPECT_TRUE(says(found(), {"'peak' is -999 in 3 of the first 64 rows", "write NaN"}));
  x_(3, 1) = x_(40, 1) = x_(41, 1) = 1e30;
  EXPECT_TRUE(says(found(), {"'peak' is 1e+30 in 3 of the first 64 rows"}));
}

TEST_F(RepeatedOutliers, AreNoneOfWhatMeasurementsDo) {
  EXPECT_EQ(found(), "");
  x_(3, 1) = 50.0;
  EXPECT_EQ(found(), "") << "a heavy tail doesn't repeat itself";
  x_.col(0) = x_.col(0).cwiseMax(-0.5);
  EXPECT_EQ(found(), "") << "a sensor that is clipped";
  for (Index i = 0; i < 64; ++i) x_(i, 0) = i % 2 == 0 ? 0.0 : 1.0;
  EXPECT_EQ(found(), "") << "a bit";
  x_.col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(found(), "") << "nothing there";
}

}  // namespace
}  // namespace npdr::pipeline
