#include "inference/diagnostics/tail_probability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

Vector exponentials(Index n, std::uint64_t seed) {
  Stream stream({seed, "exponentials", 0, 0, 0});
  return Vector::NullaryExpr(n, [&](Index) { return -std::log(stream.uniform()); });
}

TEST(TailProbability, CountsWhereThereIsEnoughToCount) {
  const Vector reference = Vector::LinSpaced(100, 1.0, 100.0);
  EXPECT_DOUBLE_EQ(tail_probability(reference, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(tail_probability(reference, 51.0), 51.0 / 101.0);
  EXPECT_DOUBLE_EQ(tail_probability(reference, 91.0), 11.0 / 101.0);
}

// P(X >= x) = exp(-x) is estimated from 1000 values to well within a factor of 10 where it is 1e-5.
TEST(TailProbability, GoesOnBeyondTheLargestValue) {
  const double found = tail_probability(exponentials(1000, 1), -std::log(1e-5));
  EXPECT_GT(found, 1e-6);
  EXPECT_LT(found, 1e-4);
}

// p < 0.002 in a share of 0.002 of all trials: 20 of 10,000 are expected with 200 values each, far
// below the 1 / 201 that counting could show. The fit of a tail to 20 values is biased, to the safe
// side where it is light; more than twice as many would be too many.
TEST(TailProbability, FalseAlarmsInTheTailAreRare) {
  int alarms = 0;
  for (std::uint64_t trial = 1; trial <= 10'000; ++trial) {
    const Vector values = exponentials(201, trial);
    alarms += tail_probability(values.head(200), values(200)) < 0.002 ? 1 : 0;
  }
  EXPECT_LT(alarms, 40);
  EXPECT_GT(alarms, 5);
}

// U^-1/2, which has no variance, and 20,000 trials: at 1e-4 two are expected. The largest 20 of 200
// values know their tail badly; 15 or more would happen by chance with a probability of 1e-8 if it
// were known, and of 0.003 at 6.5, which other programs of this fit find.
TEST(TailProbability, FalseAlarmsOfHeavyTailsAreRare) {
  int alarms = 0;
  for (std::uint64_t trial = 1; trial <= 20'000; ++trial) {
    const Vector values = (0.5 * exponentials(201, trial)).array().exp();
    alarms += tail_probability(values.head(200), values(200)) < 1e-4 ? 1 : 0;
  }
  EXPECT_LT(alarms, 15);
}

// Five of 1000 that lie together far from all others. Ten are expected to be five or fewer with a
// probability of 7 %, two to be five or more with 5 %.
TEST(TailProbability, OfWhatOtherValuesReachIsBorneOutByThem) {
  Vector values = exponentials(1000, 1);
  values.head(5) = Vector{{500.0, 501.0, 502.5, 503.0, 505.0}};
  const double found = tail_probability(values, 500.0);
  EXPECT_GT(found, 2.0 / 1000.0);
  EXPECT_LE(found, 6.0 / 1001.0);
}

TEST(TailProbability, OfDiscreteValuesIsCounted) {
  Vector binary = Vector::Zero(1000);
  binary.head(5).setOnes();
  EXPECT_DOUBLE_EQ(tail_probability(binary, 1.0), 6.0 / 1001.0);
  const Vector counts = exponentials(1000, 1).array().floor();
  EXPECT_DOUBLE_EQ(tail_probability(counts, counts.maxCoeff()),
                   static_cast<double>(1 + (counts.array() == counts.maxCoeff()).count()) / 1001.0);
  EXPECT_LT(tail_probability(counts, 100.0), 1e-4) << "none was ever as far out";
}

TEST(TailProbability, OfEqualValuesIsThatOfTheOthers) {
  Vector mostly_zero = Vector::Zero(1000);
  mostly_zero.head(50) = exponentials(50, 1);
  EXPECT_LT(tail_probability(mostly_zero, 1e6), 1e-5);
  // A quartile of a third of the largest excess, where the fit's other parameter may be 0.
  Vector counts = Vector::Zero(200);
  counts.head(110).setOnes();
  counts.head(23).setConstant(2.0);
  counts.head(3).setConstant(3.0);
  EXPECT_LT(tail_probability(counts, 1e6), 1e-4);
}

TEST(TailProbability, WhatIsNoNumberIsFarOut) {
  const Vector reference = exponentials(100, 1);
  EXPECT_DOUBLE_EQ(tail_probability(reference, kNaN), 1e-5);
  EXPECT_DOUBLE_EQ(tail_probability(Vector::Constant(100, 2.0), kNaN), 1e-5);
  EXPECT_DOUBLE_EQ(tail_probability(Vector::Constant(20, 2.0), kNaN), 5e-5);
  EXPECT_DOUBLE_EQ(tail_probability(Vector::Constant(100, kNaN), 1.0), 1.0);
  EXPECT_DOUBLE_EQ(tail_probability(Vector::Constant(100, 2.0), 3.0), 1.0 / 101.0);
  EXPECT_THROW(tail_probability(Vector(), 1.0), InputError);
}

TEST(TailProbability, SaysHowSmallItCanBe) {
  for (const Index n : {20, 39, 40, 1000}) {
    const Vector reference = Vector::LinSpaced(n, 0.0, 1.0);
    EXPECT_DOUBLE_EQ(tail_probability(reference, 1e300), smallest_tail_probability(n)) << n;
  }
}

}  // namespace
}  // namespace npdr::inference
