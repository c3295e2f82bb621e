#include "inference/diagnostics/c2st.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/normal.h"
#include "inference/diagnostics/two_samples.h"
#include "tests/inference/diagnostics/samples.h"
#include "tests/thread_count.h"

namespace npdr::inference {
namespace {

const StreamId kC2stId{1, "c2st", 0, 0, 0};

// Four standard errors: false-alarm rate 6e-5, fixed seed.
TEST(TwoSamples, CountRowsThatAreThereAgain) {
  const RowMatrix rows{{1.0, 2.0}, {1.0, 3.0}, {1.0, 2.0}, {2.0, 1.0}, {1.0, 2.0}};
  EXPECT_EQ(num_repeated_rows(rows), 2);
  EXPECT_EQ(num_repeated_rows(rows.topRows(2)), 0);
}

TEST(C2st, OfTheSameDistributionIsAHalf) {
  const C2st found = c2st(gaussian(2000, 3, 1), gaussian(2000, 3, 2), kC2stId);
  EXPECT_NEAR(found.accuracy, 0.5, 4.0 * found.standard_error);
}

// The best classifier of N(0, I) against N(mu, I) is right with probability Phi(|mu| / 2). Ours may
// beat it by luck alone (four standard errors, false-alarm rate 3e-5); what it doesn't learn from
// 4000 rows costs it less than 0.02.
TEST(C2st, OfShiftedGaussiansApproachesTheBestAccuracyFromBelow) {
  for (const double shift : {0.5, 1.0, 2.0}) {
    constexpr Index d = 2;
    const C2st found =
        c2st(gaussian(2000, d, 1), gaussian(2000, d, 2, shift / std::sqrt(d)), kC2stId);
    const double best = normal_cdf(shift / 2.0);
    EXPECT_LT(found.accuracy, best + 4.0 * found.standard_error) << shift;
    EXPECT_GT(found.accuracy, best - 4.0 * found.standard_error - 0.02) << shift;
  }
}

// The same mean, half the deviation: only the second sample's spread tells.
TEST(C2st, SeesADifferenceInSpread) {
  EXPECT_GT(c2st(gaussian(1000, 2, 1), gaussian(1000, 2, 2, 0.0, 0.5), kC2stId).accuracy, 0.65);
}

TEST(C2st, UnitsDontMatter) {
  const RowMatrix first = gaussian(200, 2, 1), second = gaussian(200, 2, 2, 0.5);
  // A power of two: no rounding.
  EXPECT_EQ(c2st(first * 0x1p-30, second * 0x1p-30, kC2stId).accuracy,
            c2st(first, second, kC2stId).accuracy);
}

// The second sample lies 10^40 deviations of the first away, beyond single precision.
TEST(C2st, OfAPointAndAnotherIsOne) {
  const RowMatrix narrow = gaussian(50, 1, 1, 0.0, 1e-40);
  EXPECT_EQ(c2st(narrow, RowMatrix::Ones(50, 1), kC2stId).accuracy, 1.0);
}

// Squares of the first sample leave the range of double.
TEST(C2st, TellsApartWhatDiffersByAnyMagnitude) {
  const RowMatrix usual = gaussian(100, 1, 1), huge = gaussian(100, 1, 2, 0.0, 1e307);
  const RowMatrix tiny = gaussian(100, 1, 3, 0.0, 1e-307);
  EXPECT_GT(c2st(huge, usual, kC2stId).accuracy, 0.8);
  EXPECT_GT(c2st(usual, huge, kC2stId).accuracy, 0.8);
  EXPECT_GT(c2st(tiny, usual, kC2stId).accuracy, 0.8);
  EXPECT_LT(c2st(huge, gaussian(100, 1, 4, 0.0, 1e307), kC2stId).accuracy, 0.7);
}

TEST(C2st, SameBitsForAnyThreadCount) {
  const RowMatrix first = gaussian(203, 2, 1), second = gaussian(203, 2, 2, 0.5);
  expect_same_for_any_thread_count([&] { return c2st(first, second, kC2stId).fold_accuracy; });
}

TEST(C2st, RejectsWhatCantBeCompared) {
  const RowMatrix good = gaussian(20, 2, 1);
  EXPECT_THROW(c2st(good, gaussian(20, 3, 2), kC2stId), ShapeError);
  EXPECT_THROW(c2st(good, gaussian(19, 2, 2), kC2stId), ShapeError);
  EXPECT_THROW(c2st(good.topRows(9), good.topRows(9), kC2stId), InputError);
  RowMatrix broken = good;
  broken(3, 1) = kNaN;
  EXPECT_THROW(c2st(good, broken, kC2stId), InputError);
}

}  // namespace
}  // namespace npdr::inference
