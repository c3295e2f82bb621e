#include "pipeline/stages/power_search.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

Vector crps(double first, double second) { return Vector{{first, second}}; }

TEST(PowerSearch, TakesTheSmallestThatIsAboutAsGoodAsTheBest) {
  PowerSearch search({});
  search.add(0.1, crps(0.30, 0.40));
  search.add(0.4, crps(0.10, 0.20));
  search.add(0.2, crps(0.1005, 0.2005));  // a level that fell back
  search.add(0.3, crps(0.12, 0.22));
  EXPECT_EQ(search.scores().power, (Vector{{0.1, 0.2, 0.3, 0.4}}));
  EXPECT_EQ(search.scores().crps(1, 0), 0.1005);
  EXPECT_EQ(search.best(), 0.2) << "worse by less than a hundredth";
  EXPECT_FALSE(search.ends_at_best(1.0));
}

TEST(PowerSearch, WhatRolloutsDisagreeAboutIsntWorse) {
  PowerSearch search({});
  search.add(0.1, crps(0.09, 0.23));  // worse by 0.01 +- 0.02 (standard error)
  search.add(0.2, crps(0.10, 0.20));
  EXPECT_EQ(search.best(), 0.1);
  PowerSearch sure({});
  sure.add(0.1, crps(0.11, 0.22));  // worse by 0.015 +- 0.005
  sure.add(0.2, crps(0.10, 0.20));
  EXPECT_EQ(sure.best(), 0.2);
  EXPECT_TRUE(sure.ends_at_best(1.0));
  EXPECT_FALSE(sure.ends_at_best(0.2));
}

TEST(PowerSearch, EndsWhereMoreCantHelpOrIsOutOfReach) {
  PowerSearch search({});
  EXPECT_FALSE(search.is_over(1.0));
  search.add(0.1, crps(0.1, 0.2));
  EXPECT_FALSE(search.is_over(1.0));
  EXPECT_TRUE(search.is_over(0.1)) << "all that is wanted";
  search.add(0.31, crps(0.2, 0.3));
  EXPECT_TRUE(search.is_over(1.0)) << "three times the best";
  PowerSearch stuck({});
  for (int i = 0; i <= 10; ++i) {
    EXPECT_FALSE(stuck.is_over(1.0)) << i;
    stuck.add(0.2 + 0.001 * i, crps(0.2 - 0.01 * i, 0.3 - 0.01 * i));
  }
  EXPECT_TRUE(stuck.is_over(1.0));
}

}  // namespace
}  // namespace npdr::pipeline
