#include "pipeline/import/rate_pairs.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

TEST(RatePairs, HaveTheSameNameAndAUnitPerSecond) {
  EXPECT_EQ(rate_pairs({{"theta", "rad"}, {"theta_dot", "rad/s"}, {"x_dot", "m/s"}, {"x", "m"}}),
            (std::vector<RatePair>{{0, 1}, {3, 2}}));
  EXPECT_TRUE(rate_pairs({{"theta", "deg"}, {"theta_dot", "rad/s"}}).empty());
  EXPECT_TRUE(rate_pairs({{"theta", "rad"}, {"thetadot", "rad/s"}}).empty());
  EXPECT_EQ(rate_pairs({{"x", "m"}, {"x_dot", "m/s"}, {"x_dot_dot", "m/s^2"}}),
            (std::vector<RatePair>{{0, 1}, {1, 2}}));
  EXPECT_EQ(rate_unit("1"), "1/s");
  EXPECT_TRUE(is_rate_of({"theta_dot", ""}, {"theta", "rad"})) << "an unknown unit may be any";
  EXPECT_TRUE(is_rate_of({"theta_dot", "rad/s"}, {"theta", ""}));
  EXPECT_FALSE(is_rate_of({"theta_dot", "deg/s"}, {"theta", "rad"}));
}

TEST(RatePairs, MayBeNamedOtherwise) {
  using Pairs = std::vector<RatePair>;
  EXPECT_EQ(likely_rate_pairs({{"swing speed", "rad/s"}, {"swing", "rad"}}), (Pairs{{1, 0}}));
  EXPECT_EQ(likely_rate_pairs({{"q", "rad"}, {"q1", "rad"}, {"qd", "rad/s"}, {"q1d", "rad/s"}}),
            (Pairs{{0, 2}, {1, 3}}));
  EXPECT_TRUE(likely_rate_pairs({{"swing", "deg"}, {"swing speed", "rad/s"}}).empty());
  EXPECT_TRUE(likely_rate_pairs({{"swing", ""}, {"swing speed", ""}}).empty());
  EXPECT_EQ(likely_rate_pairs({{"v", "m/s"}, {"q", "m"}, {"load", "N"}}), (Pairs{{1, 0}}));
  EXPECT_TRUE(likely_rate_pairs({{"angle", "rad"}, {"arm", "rad"}, {"speed", "rad/s"}}).empty());
  const std::vector<Channel> with_wanted = {
      {"q", "rad"}, {"q1", "rad"}, {"q1_dot", "rad/s"}, {"q1_wanted", "rad/s"}};
  EXPECT_TRUE(likely_rate_pairs(with_wanted).empty()) << "q1 has its rate";
}

TEST(RatePairs, TellPositions) {
  EXPECT_EQ(
      positions_of({{"x", "m"}, {"x_dot", "m/s"}, {"q", "rad"}, {"v", "rad/s"}, {"load", "N"}}),
      (std::vector<Index>{0, 2}))
      << "a load may leap";
  EXPECT_EQ(positions_of({{"q", ""}, {"q_dot", ""}}), std::vector<Index>{0});
}

}  // namespace
}  // namespace npdr::pipeline
