#include "inference/diagnostics/sbc.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace npdr::inference {
namespace {

TEST(Sbc, RankCountsTheSmallerSamples) {
  RowMatrix samples(4, 2);
  samples << 1, 10, 2, 20, 3, 30, 4, 40;
  EXPECT_EQ(ranks(samples, Vector{{2.5, 5.0}}), (std::vector<Index>{2, 0}));
  EXPECT_THROW(ranks(samples, Vector::Zero(3)), ShapeError);
}

// Ranks of theta* ~ N(shift, 1) among 99 draws of N(0, width^2), as numbers on (0, 1).
Vector spread_ranks_of(double width, double shift) {
  std::vector<Index> all;
  for (std::uint64_t i = 0; i < 500; ++i) {
    Stream stream({1, "sbc", 0, i, 0});
    RowMatrix samples(99, 1);
    for (double& s : samples.reshaped()) s = width * stream.normal();
    all.push_back(ranks(samples, Vector{{shift + stream.normal()}}).front());
  }
  return spread_ranks(all, 99, {1, "spread", 0, 0, 0});
}

TEST(Sbc, FindsPosteriorsThatAreTooNarrowTooWideOrShifted) {
  EXPECT_GT(test_sbc(spread_ranks_of(1.0, 0.0)).p_value, 0.01);  // false-alarm rate 1 %, fixed seed
  EXPECT_LT(test_sbc(spread_ranks_of(0.75, 0.0)).p_value, 1e-4);
  EXPECT_LT(test_sbc(spread_ranks_of(1.33, 0.0)).p_value, 1e-4);
  EXPECT_LT(test_sbc(spread_ranks_of(1.0, 0.3)).p_value, 1e-4);
}

// Of an exact posterior over five values; false-alarm rate 1 %, fixed seed.
TEST(Sbc, RanksOfTiesAreUniform) {
  std::vector<Index> all;
  for (std::uint64_t i = 0; i < 500; ++i) {
    Stream stream({1, "ties", 0, i, 0});
    RowMatrix samples(100, 1);
    for (double& s : samples.reshaped()) s = stream.below(5);
    all.push_back(ranks(samples, Vector{{static_cast<double>(stream.below(5))}}).front());
  }
  EXPECT_GT(test_sbc(spread_ranks(all, 100, {1, "spread", 0, 0, 0})).p_value, 0.01);
}

TEST(Sbc, CorrectsForTheNumberOfParameters) {
  const Vector spread = spread_ranks_of(1.0, 0.1);
  const Sbc one = test_sbc(spread), three = test_sbc(spread.replicate(1, 3));
  ASSERT_LT(one.p_value, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(three.p_value, 3.0 * one.p_value);
  EXPECT_EQ(three.parameter_p_value, Vector::Constant(3, one.p_value));
}

}  // namespace
}  // namespace npdr::inference
