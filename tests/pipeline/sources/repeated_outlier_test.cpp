#include "pipeline/sources/repeated_outlier.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/random.h"
#include "tests/message_of.h"
#include "tests/words_of.h"

namespace npdr::pipeline {
namespace {

class RepeatedOutlier : public testing::Test {
 protected:
  // 64 rows of two standard normal columns.
  RepeatedOutlier() : x_(64, 2) {
    Stream stream({1, "test", 0, 0, 0});
    for (float& value : x_.reshaped()) value = static_cast<float>(stream.normal());
  }

  // Of two blocks.
  std::string found() const {
    RepeatedOutliers outliers(2);
    outliers.observe(x_.topRows(40));
    outliers.observe(x_.bottomRows(24));
    return words_of(outliers.find({{"total", "1"}, {"peak", "m"}}));
  }

  RowMatrixF x_;
};

TEST_F(RepeatedOutlier, AreNamedWithTheirNumber) {
  x_(3, 1) = x_(40, 1) = x_(41, 1) = -999.0f;
  EXPECT_TRUE(says(found(), {"'peak' is -999 in 3 of 64 rows", "write NaN"}));
  x_(3, 1) = x_(40, 1) = x_(41, 1) = 1e30f;
  EXPECT_TRUE(says(found(), {"'peak' is 1e+30 in 3 of 64 rows"}));
}

TEST_F(RepeatedOutlier, AreNoneOfWhatMeasurementsDo) {
  EXPECT_EQ(found(), "");
  x_(3, 1) = 50.0f;
  EXPECT_EQ(found(), "") << "a heavy tail doesn't repeat itself";
  x_.col(0) = x_.col(0).cwiseMax(-0.5f);
  EXPECT_EQ(found(), "") << "a sensor that is clipped";
  for (Index i = 0; i < 64; ++i) x_(i, 0) = i % 2 == 0 ? 0.0f : 1.0f;
  EXPECT_EQ(found(), "") << "a bit";
  x_.col(0).setConstant(kFloatNaN);
  EXPECT_EQ(found(), "") << "nothing there";
}

}  // namespace
}  // namespace npdr::pipeline
