#include "inference/missed_share.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "inference/standard_normal.h"

namespace npdr::inference {
namespace {

constexpr double kPiWidth = 0.1;

double log_gaussian_at(const Vector& u, double mean, double width) {
  Vector away = u;
  away(0) -= mean;
  return -0.5 * away.squaredNorm() / (width * width) -
         static_cast<double>(u.size()) * std::log(width * std::sqrt(2.0 * std::numbers::pi));
}

// q: a Gaussian around (1, 0, ...). pi: the same, kPiWidth wide, and as much around (-1, 0, ...).
double share_of_two_modes(Index dimension, double width, bool has_second, std::uint64_t seed) {
  const StreamId id{seed, "draws", 0, 0, 0};
  RowMatrix u = width * draw_standard_normal(2000, dimension, id);
  u.col(0).array() += 1.0;
  const auto densities = [&](const RowMatrix& at) {
    const Vector prior = log_standard_normal<double>(at);
    ComparedDensities here{Vector(at.rows()), Vector(at.rows())};
    for (Index i = 0; i < at.rows(); ++i) {
      const Vector row = at.row(i).transpose();
      const double first = log_gaussian_at(row, 1.0, kPiWidth);
      const double second = log_gaussian_at(row, -1.0, kPiWidth);
      const double both = std::max(first, second) + std::log1p(std::exp(-std::abs(first - second)));
      here.q(i) = log_gaussian_at(row, 1.0, width) - prior(i);
      here.pi(i) = 7.0 + (has_second ? both : first) - prior(i);
    }
    return here;
  };
  return missed_share(u, densities, id);
}

// Of 2000 + 2000 draws the share has a standard error of about 0.02, and of 9 dimensions more, as
// few of those around the second mode count.
TEST(MissedShare, IsThatOfAModeWithoutDraws) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    for (const double width : {1.0, 2.0}) {
      EXPECT_NEAR(share_of_two_modes(1, width * kPiWidth, true, seed), 0.5, 0.08);
      EXPECT_NEAR(share_of_two_modes(3, width * kPiWidth, true, seed), 0.5, 0.08);
      EXPECT_GT(share_of_two_modes(9, width * kPiWidth, true, seed), 0.25);
    }
  }
}

TEST(MissedShare, IsSmallOfADensityOfAnotherWidth) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    for (const Index dimension : {1, 3, 9}) {
      EXPECT_EQ(share_of_two_modes(dimension, kPiWidth, false, seed), 0.0);
      EXPECT_EQ(share_of_two_modes(dimension, 3.0 * kPiWidth, false, seed), 0.0);
      // Half as wide in nine dimensions q has next to none of pi, by any name.
      EXPECT_LT(share_of_two_modes(dimension, 0.5 * kPiWidth, false, seed),
                dimension < 9 ? 0.1 : 0.5);
    }
  }
}

TEST(MissedShare, OfNothingIsNothing) {
  const RowMatrix u = draw_standard_normal(100, 2, {1, "draws", 0, 0, 0});
  const auto nan = [](const RowMatrix& at) -> ComparedDensities {
    return {Vector::Zero(at.rows()), Vector::Constant(at.rows(), std::nan(""))};
  };
  EXPECT_EQ(missed_share(u, nan, {1, "draws", 0, 0, 0}), 0.0);
}

}  // namespace
}  // namespace npdr::inference
