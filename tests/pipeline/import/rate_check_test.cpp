#include <gtest/gtest.h>

#include "pipeline/import/rate_check.h"
#include "pipeline/import/rates.h"
#include "tests/pipeline/import/encoder_motion.h"

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

std::optional<RateFit> fit(const Motion& motion) {
  return fit_rate(motion.position, motion.rate, motion.dt);
}

TEST(RateCheck, ExactRatesHaveTheRatioOne) {
  const std::optional<RateFit> found = fit(smooth_motion(1000, 0.004, 1));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->ratio, 1.0, 1e-3);
  EXPECT_LT(found->scatter, 1e-3);
  EXPECT_EQ(verdict_of(*found), RateVerdict::agrees);
}

// None of 500 right recordings is blamed: were one of 100 blamed, this would pass once in 150
// times.
TEST(RateCheck, WhatLabsRecordPasses) {
  for (const double dt : {0.002, 0.004, 0.01, 0.02}) {
    for (std::uint64_t row = 1; row <= 25; ++row) {
      const std::vector<Motion> all = recorded(smooth_motion(1000, dt, row), row);
      for (std::size_t device = 0; device < all.size(); ++device) {
        const std::optional<RateFit> found = fit(all[device]);
        ASSERT_TRUE(found) << dt << " " << row << " " << device;
        EXPECT_EQ(verdict_of(*found), RateVerdict::agrees)
            << dt << " " << row << " " << device << ": " << found->ratio << " +- " << found->scatter
            << " over " << found->window;
        EXPECT_TRUE(find_leaps(all[device].position, all[device].rate, dt).empty())
            << dt << " " << row << " " << device;
      }
    }
  }
}

TEST(RateCheck, FactorsAreFoundInNoise) {
  for (const double factor : {57.3, 1.0 / 57.3, 1.5, 0.67, 1000.0, -1.0}) {
    for (std::uint64_t row = 1; row <= 25; ++row) {
      for (Motion motion : recorded(smooth_motion(1000, 0.004, row), row)) {
        motion.position *= factor;
        const std::optional<RateFit> found = fit(motion);
        ASSERT_TRUE(found) << factor << " " << row;
        EXPECT_EQ(verdict_of(*found), RateVerdict::scaled) << factor << " " << row;
        EXPECT_NEAR(found->ratio / factor, 1.0, 0.1) << factor << " " << row;
      }
    }
  }
}

// A quarter is more than what filters, noise and rounding make of most rates: without any, an
// eighth less than that is found, too.
TEST(RateCheck, AWrongStepOfTimeIsFound) {
  Motion motion = smooth_motion(1000, 0.004, 1);
  motion.dt = 0.005;
  EXPECT_NEAR(fit(motion)->ratio, 0.8, 1e-3);
  EXPECT_EQ(verdict_of(*fit(motion)), RateVerdict::scaled);
  motion.dt = 0.0044;
  EXPECT_EQ(verdict_of(*fit(motion)), RateVerdict::agrees) << "within the tolerance";
}

TEST(RateCheck, AnotherMotionsRateIsUnrelated) {
  for (std::uint64_t row = 1; row <= 50; ++row) {
    Motion motion = recorded(smooth_motion(1000, 0.004, row), row)[3];
    motion.rate = smooth_motion(1000, 0.004, row + 500).rate;
    const std::optional<RateFit> found = fit(motion);
    ASSERT_TRUE(found) << row;
    EXPECT_NE(verdict_of(*found), RateVerdict::agrees) << row;
  }
  Motion motion = smooth_motion(1000, 0.004, 1);
  motion.rate.setZero();
  EXPECT_EQ(verdict_of(fit(motion).value()), RateVerdict::unrelated);
}

TEST(RateCheck, ASteadyMotionIsMotion) {
  for (const double rate : {0.5, 10.0, 500.0}) {
    const Motion motion = {Vector::LinSpaced(300, 0.0, rate * 2.99), Vector::Constant(300, rate),
                           0.01};
    ASSERT_TRUE(fit(motion)) << rate;
    EXPECT_NEAR(fit(motion)->ratio, 1.0, 1e-9) << rate;
  }
}

TEST(RateCheck, GlitchesDontCount) {
  Motion motion = recorded(smooth_motion(1000, 0.004, 2), 2)[0];
  for (Index t = 50; t < 1000; t += 100) {
    motion.position(t) += 30.0;
    motion.rate(t + 20) -= 500.0;
  }
  EXPECT_EQ(verdict_of(fit(motion).value()), RateVerdict::agrees);
}

TEST(RateCheck, StepsThatTheRateKnowsNothingOfAreFound) {
  const auto leaps_of = [](const Motion& motion) {
    return find_leaps(motion.position, motion.rate, motion.dt);
  };
  for (const Motion& right : recorded(smooth_motion(1000, 0.004, 1), 1)) {
    const double range = right.position.maxCoeff() - right.position.minCoeff();
    Motion moved = right;
    moved.position.tail(600).array() += range;
    EXPECT_EQ(leaps_of(moved), std::vector<Index>{399});
    Motion lost = right;
    lost.position.segment(400, 40).setConstant(right.position.maxCoeff() + range);
    EXPECT_EQ(leaps_of(lost), (std::vector<Index>{399, 439}));
    Motion glitch = right;
    glitch.position(400) += range;
    EXPECT_TRUE(leaps_of(glitch).empty()) << "told elsewhere";
  }
}

// Falls from rest, and lies still for the rest of 20 s: a camera's millimetres, exact rates.
TEST(RateCheck, AnImpactAfterRestIsNone) {
  constexpr double dt = 0.01;
  for (int begin = 0; begin < 40; ++begin) {
    Vector height(2000), rate(2000);
    for (Index t = 0; t < 2000; ++t) {
      const double s = dt * (static_cast<double>(t) - 1900.0 - 0.1 * begin);
      const bool falls = s > 0.0 && s < 0.45;
      const double exact = s <= 0.0 ? 1.0 : falls ? 1.0 - 0.5 * 9.81 * s * s : 0.0;
      height(t) = 1e-3 * std::round(1e3 * exact);
      rate(t) = falls ? -9.81 * s : 0.0;
    }
    EXPECT_TRUE(find_leaps(height, rate, dt).empty()) << begin;
  }
}

TEST(RateCheck, NothingIsSaidWithoutMotionOrOfFewSamples) {
  const Vector rest = Vector::Zero(1000);
  EXPECT_FALSE(fit({rest, rest, 0.004}));
  EXPECT_FALSE(fit({rest, with_noise(rest, 0.3, 1), 0.004}));
  EXPECT_FALSE(fit({rest, with_noise(rest, 0.3, 1).array() + 0.02, 0.004})) << "a biased gyroscope";
  EXPECT_FALSE(fit({with_noise(rest, 2e-3, 1), with_noise(rest, 0.3, 2), 0.004}));
  EXPECT_FALSE(fit({rounded(with_noise(rest, 1e-3, 1), 3e-3), rest, 0.004}))
      << "a count to and fro";
  EXPECT_FALSE(fit({rest.array() + 0.7, rest.array() + 0.1, 0.004}))
      << "the slope of a constant is rounding";
  EXPECT_FALSE(fit(smooth_motion(kFewestSamples - 1, 0.02, 1)));
  EXPECT_EQ(verdict_of(fit(smooth_motion(60, 0.02, 1)).value()), RateVerdict::agrees);
}

}  // namespace
}  // namespace npdr::pipeline
