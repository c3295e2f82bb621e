#include "inference/diagnostics/excess_width.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

struct WideDraws {
  RowMatrix theta;  // (n, 1)
  RowMatrixF x;     // (n, F)
};

// A posterior `times` as wide as it should be: theta ~ N(0, times^2 / F), F features theta + N(0,
// 1).
WideDraws wide_gaussian(double times, Index n, Index num_features, std::uint64_t seed) {
  WideDraws draws{RowMatrix(n, 1), RowMatrixF(n, num_features)};
  for (Index i = 0; i < n; ++i) {
    Stream stream({seed, "draws", 0, static_cast<std::uint64_t>(i), 0});
    draws.theta(i, 0) = times / std::sqrt(static_cast<double>(num_features)) * stream.normal();
    for (float& value : draws.x.row(i)) {
      value = static_cast<float>(draws.theta(i, 0) + stream.normal());
    }
  }
  return draws;
}

double excess_of(const WideDraws& draws) { return excess_width(draws.theta, draws.x)(0); }

TEST(ExcessWidth, IsThatOfGaussiansOfAnyNumberOfFeatures) {
  for (const Index num_features : {1, 20, 400}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      for (const double times : {2.0, 3.0}) {
        const double found = excess_of(wide_gaussian(times, 1000, num_features, seed));
        EXPECT_GT(found, 0.8 * times) << num_features << " features, seed " << seed;
        EXPECT_LT(found, 1.3 * times) << num_features << " features, seed " << seed;
      }
    }
  }
}

// Of 200 draws, which a diagnosis has by default: 1.6 is its limit.
TEST(ExcessWidth, TellsRightPosteriorsFromThoseThreeTimesAsWide) {
  for (const Index num_features : {1, 20, 400}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      EXPECT_LT(excess_of(wide_gaussian(1.0, 200, num_features, seed)), 1.5) << num_features;
      EXPECT_GT(excess_of(wide_gaussian(3.0, 200, num_features, seed)), 1.6) << num_features;
    }
  }
}

TEST(ExcessWidth, IsFoundInSpreadsThatParametersGive) {
  WideDraws draws = wide_gaussian(1.0, 1000, 40, 1);
  for (Index i = 0; i < draws.x.rows(); ++i) {
    Stream stream({2, "spreads", 0, static_cast<std::uint64_t>(i), 0});
    draws.theta(i, 0) = 3.0 / std::sqrt(80.0) * stream.normal();  // of log sigma
    const double sigma = std::exp(draws.theta(i, 0));
    for (float& value : draws.x.row(i)) value = static_cast<float>(sigma * stream.normal());
  }
  EXPECT_GT(excess_of(draws), 1.8);
}

TEST(ExcessWidth, OfWhatFeaturesDontTellIsSmall) {
  WideDraws draws = wide_gaussian(1.0, 500, 5, 1);
  draws.x.setConstant(1.0f);
  EXPECT_EQ(excess_of(draws), 0.0);
  draws.x = wide_gaussian(1.0, 500, 5, 2).x;
  EXPECT_LT(excess_of(draws), 0.5);
  draws.theta.setConstant(0.3);
  EXPECT_EQ(excess_of(draws), 0.0) << "known";
}

TEST(ExcessWidth, OfCopiesOfAFeatureIsThatOfOne) {
  WideDraws draws = wide_gaussian(1.0, 1000, 1, 1);
  draws.x = draws.x.replicate(1, 100).eval();
  EXPECT_LT(excess_of(draws), 1.2);
}

TEST(ExcessWidth, RefusesWhatItCantJudge) {
  EXPECT_THROW(excess_width(RowMatrix::Zero(99, 1), RowMatrixF::Zero(99, 1)), InputError);
  EXPECT_THROW(excess_width(RowMatrix::Zero(200, 1), RowMatrixF::Zero(199, 1)), ShapeError);
  RowMatrixF x = RowMatrixF::Zero(200, 2);
  x(7, 1) = NAN;
  EXPECT_THROW(excess_width(RowMatrix::Zero(200, 1), x), InputError);
}

}  // namespace
}  // namespace npdr::inference
