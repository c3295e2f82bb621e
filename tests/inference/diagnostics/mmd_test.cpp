#include "inference/diagnostics/mmd.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "tests/inference/diagnostics/samples.h"
#include "tests/thread_count.h"

namespace npdr::inference {
namespace {

const StreamId kMmdId{1, "mmd", 0, 0, 0};

// Under the hypothesis p-values are uniform: the mean of 40 lies within four of its standard
// errors, 1 / sqrt(12 * 40), of 0.5. False-alarm rate 6e-5.
TEST(Mmd, OfTheSameDistributionHasUniformPValues) {
  double sum = 0.0;
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    const Mmd found = mmd(gaussian(60, 2, 2 * trial + 1), gaussian(80, 2, 2 * trial + 2), kMmdId);
    sum += found.p_value;
  }
  EXPECT_NEAR(sum / 40.0, 0.5, 4.0 / std::sqrt(12.0 * 40.0));
}

// E k of x ~ N(a, p^2 I), y ~ N(b, q^2 I) is (s^2 / (s^2 + v))^(D/2) exp(-|a - b|^2 / (2 (s^2 +
// v))) with v = p^2 + q^2: in the standardized space that the bandwidth belongs to.
TEST(Mmd, OfShiftedGaussiansIsTheKnownOne) {
  constexpr double shift = 1.0;
  constexpr Index n = 2000;
  const Mmd found = mmd(gaussian(n, 1, 1), gaussian(n, 1, 2, shift), kMmdId);
  const double variance = 1.0 / (1.0 + shift * shift / 4.0);  // of one sample, standardized
  const double s2 = found.bandwidth * found.bandwidth, sum = s2 + 2.0 * variance;
  const double expected =
      2.0 * std::sqrt(s2 / sum) * (1.0 - std::exp(-shift * shift * variance / (2.0 * sum)));
  // d MMD^2 / d shift is about 2 MMD^2 / shift, and the shift has a standard error of
  // sqrt(2 / n): four of them are 25 %.
  EXPECT_NEAR(found.squared / expected, 1.0, 0.25);
  EXPECT_NEAR(found.p_value, 1.0 / 201.0, 1e-12);
}

TEST(Mmd, SeesADifferenceInSpread) {
  EXPECT_LT(mmd(gaussian(500, 2, 1), gaussian(500, 2, 2, 0.0, 0.7), kMmdId).p_value, 0.01);
}

// Against the sums of eq. 3 as they are written, over more rows than a tile has.
TEST(Mmd, TilesAddUpToAllPairs) {
  const RowMatrix first = gaussian(600, 2, 1), second = gaussian(500, 2, 2, 0.3);
  const Mmd found = mmd(first, second, kMmdId, {.num_permutations = 1});
  RowMatrix x(1100, 2);
  x << first, second;
  const Eigen::RowVectorXd mean = x.colwise().mean();
  x.rowwise() -= mean;
  for (Index d = 0; d < 2; ++d) x.col(d) /= std::sqrt(x.col(d).squaredNorm() / 1099.0);
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (Index i = 0; i < 1100; ++i) {
    for (Index j = 0; j < 1100; ++j) {
      if (i == j) continue;
      const double k = std::exp(-(x.row(i) - x.row(j)).squaredNorm() /
                                (2.0 * found.bandwidth * found.bandwidth));
      (i < 600 && j < 600 ? xx : i >= 600 && j >= 600 ? yy : xy) += k;
    }
  }
  const double expected = xx / (600.0 * 599.0) + yy / (500.0 * 499.0) - xy / (600.0 * 500.0);
  EXPECT_NEAR(found.squared, expected, 1e-6);  // single precision
}

TEST(Mmd, OfConstantSamplesIsNothing) {
  const Mmd found = mmd(RowMatrix::Ones(20, 2), RowMatrix::Ones(20, 2), kMmdId);
  EXPECT_NEAR(found.squared, 0.0, 1e-12);
  EXPECT_EQ(found.p_value, 1.0);
}

TEST(Mmd, SameBitsForAnyThreadCount) {
  const RowMatrix first = gaussian(700, 2, 1), second = gaussian(900, 2, 2, 0.1);
  expect_same_for_any_thread_count([&] {
    const Mmd found = mmd(first, second, kMmdId);
    return std::pair(found.squared, found.p_value);
  });
}

TEST(Mmd, RejectsWhatCantBeCompared) {
  EXPECT_THROW(mmd(gaussian(20, 2, 1), gaussian(20, 3, 2), kMmdId), ShapeError);
  EXPECT_THROW(mmd(gaussian(20, 2, 1), gaussian(5, 2, 2), kMmdId), InputError);
  RowMatrix broken = gaussian(20, 2, 1);
  broken(0, 0) = kInfinity;
  EXPECT_THROW(mmd(broken, gaussian(20, 2, 2), kMmdId), InputError);
}

}  // namespace
}  // namespace npdr::inference
