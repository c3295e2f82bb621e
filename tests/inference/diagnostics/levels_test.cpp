#include "inference/diagnostics/levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "inference/diagnostics/uniformity.h"

namespace npdr::inference {
namespace {

const Marginal kUnit{"a", "1", Marginal::Kind::uniform, 0.0, 1.0};

TEST(Levels, CountHowOftenAValueIsThere) {
  const Levels levels = levels_of(Vector{{2.0, 1.0, 2.0, 2.0}});
  EXPECT_EQ(levels, (Levels{{1.0, 1}, {2.0, 3}}));
}

TEST(Levels, OfAGridFillIt) {
  EXPECT_NEAR(filled_by_steps(levels_of(Vector::LinSpaced(11, -1.0, 1.0))), 1.0, 1e-9);
  EXPECT_EQ(filled_by_factors(levels_of(Vector::LinSpaced(11, -1.0, 1.0))), 0.0);
  EXPECT_NEAR(filled_by_factors(levels_of(Vector{{0.1, 1.0, 10.0}})), 1.0, 1e-9);
  EXPECT_NEAR(filled_by_steps(levels_of(Vector{{0.0, 1.0, 4.0}})), 0.5, 1e-9);
  EXPECT_EQ(filled_by_steps(levels_of(Vector::Constant(3, 7.0))), 1.0);
  EXPECT_NEAR(filled_by_steps(levels_of(Vector{{0.1, 0.2, 0.3, 0.1 + 0.2, 0.4}})), 1.0, 1e-9);
  const Vector draws = sample_prior(Prior({kUnit}), 200, 1).col(0);
  EXPECT_FALSE(is_grid(levels_of(draws)));
  EXPECT_TRUE(is_grid(levels_of((draws.array() * 50.0).round() / 50.0)));
}

TEST(Levels, AreChosenWhereTheyAreAGridOrRounded) {
  EXPECT_TRUE(is_rounded(0.000123456));
  EXPECT_TRUE(is_rounded(-1.5e9));
  EXPECT_FALSE(is_rounded(1.0 / 3.0));
  EXPECT_TRUE(is_rounded(std::numeric_limits<double>::denorm_min()));
  EXPECT_TRUE(are_chosen(levels_of(Vector::LinSpaced(7, 0.0, 1.0))));
  EXPECT_TRUE(are_chosen(levels_of(Vector{{0.0, 1.0, 10.0, 11.5, 300.0}})));
  EXPECT_FALSE(are_chosen(levels_of(sample_prior(Prior({kUnit}), 20, 1).col(0))));
}

TEST(Levels, AreADesignWhereFewAreChosenAndRepeated) {
  const Vector grid = Vector::LinSpaced(kFewLevels, 0.0, 1.0);
  EXPECT_FALSE(is_design(levels_of(grid)));
  EXPECT_TRUE(is_design(levels_of(grid.replicate(2, 1))));
  EXPECT_FALSE(is_design(levels_of(Vector::LinSpaced(kFewLevels + 1, 0.0, 1.0).replicate(2, 1))));
  const Vector draws = sample_prior(Prior({kUnit}), kFewLevels, 1).col(0);
  EXPECT_FALSE(is_design(levels_of(draws.replicate(2, 1))));
}

// Of values that are there once Kolmogorov's and Smirnov's, less 1 / n.
TEST(Levels, AreAsFarFromThePriorAsDrawsAre) {
  const Vector draws = sample_prior(Prior({kUnit}), 500, 1).col(0);
  const double statistic = test_kolmogorov_smirnov(draws).statistic;
  EXPECT_NEAR(distance_of_levels(levels_of(draws), kUnit), statistic - 1.0 / 500.0, 1e-12);
  for (const double levels : {2.0, 5.0, 30.0}) {
    const Vector rounded = (draws.array() * levels).round() / levels;
    EXPECT_LE(distance_of_levels(levels_of(rounded), kUnit), statistic) << levels;
  }
  EXPECT_EQ(distance_of_levels(levels_of(Vector::LinSpaced(10, 0.05, 0.95)), kUnit), 0.0);
  EXPECT_NEAR(distance_of_levels(levels_of(Vector::Constant(9, 0.4)), kUnit), 0.0, 1e-15);
  // All values are up to 0.5, half of the prior.
  EXPECT_NEAR(distance_of_levels(levels_of(Vector::LinSpaced(10, 0.0, 0.5)), kUnit), 0.4, 1e-12);
}

}  // namespace
}  // namespace npdr::inference
