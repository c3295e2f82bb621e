#include "core/log_sum_exp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/constants.h"

namespace npdr {
namespace {

TEST(LogSumExp, SurvivesLargeValues) {
  EXPECT_DOUBLE_EQ(log_sum_exp(Vector{{1000.0, 1000.0}}), 1000.0 + std::log(2.0));
  EXPECT_EQ(log_sum_exp(Vector{{-kInfinity, -kInfinity}}), -kInfinity);
}

TEST(LogSumExp, OfRowsAndOfTerms) {
  const std::vector<Vector> terms = {Vector{{-kInfinity, 0.0}}, Vector{{-kInfinity, 0.0}}};
  EXPECT_EQ(log_sum_exp_of_terms(terms)(0), -kInfinity);
  EXPECT_DOUBLE_EQ(log_sum_exp_of_terms(terms)(1), std::log(2.0));
  EXPECT_DOUBLE_EQ(log_sum_exp_of_rows(RowMatrix{{-kInfinity, 0.0}, {800.0, 800.0}})(1),
                   800.0 + std::log(2.0));
}

}  // namespace
}  // namespace npdr
