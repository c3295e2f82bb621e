#include "analysis/calibration.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

TEST(Calibration, RankCountsTheSmallerSamples) {
  RowMatrix samples(4, 2);
  samples << 1, 10, 2, 20, 3, 30, 4, 40;
  EXPECT_EQ(ranks(samples, Vector{{2.5, 5.0}}), (std::vector<Index>{2, 0}));
  EXPECT_THROW(ranks(samples, Vector::Zero(3)), ShapeError);
}

// Tabled quantiles of chi^2: 16.919 is the 95 % point for nine degrees of freedom, 3.841 for one.
TEST(Calibration, PValueIsTheChiSquareTail) {
  std::vector<Index> nearly_even;  // counts 60 and 40 of 100: chi^2 = 4, p = 0.0455003
  nearly_even.insert(nearly_even.end(), 60, 0);
  nearly_even.insert(nearly_even.end(), 40, 1);
  const UniformityTest test = test_uniform_ranks(nearly_even, 1, 2);
  EXPECT_EQ(test.counts, (std::vector<Index>{60, 40}));
  EXPECT_DOUBLE_EQ(test.chi_square, 4.0);
  EXPECT_NEAR(test.p_value, 0.0455003, 1e-6);
}

TEST(Calibration, FindsPosteriorsThatAreTooNarrow) {
  // theta* ~ N(0, 1); the "posterior" is a tenth narrower and broader than that, or just right.
  const auto p_value = [](double width) {
    std::vector<Index> all;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      Stream stream({1, "calibration", 0, i, 0});
      RowMatrix samples(99, 1);
      for (double& s : samples.reshaped()) s = width * stream.normal();
      all.push_back(ranks(samples, Vector{{stream.normal()}}).front());
    }
    return test_uniform_ranks(all, 99, 10).p_value;
  };
  EXPECT_GT(p_value(1.0), 0.01);  // false-alarm rate 1 %, fixed seed
  EXPECT_LT(p_value(0.8), 1e-4);
  EXPECT_LT(p_value(1.25), 1e-4);
}

TEST(Calibration, RejectsWhatCannotBeBinned) {
  EXPECT_THROW(test_uniform_ranks({}, 99, 10), InputError);
  EXPECT_THROW(test_uniform_ranks({5}, 99, 7), InputError);
  EXPECT_THROW(test_uniform_ranks({5}, 99, 1), InputError);
  EXPECT_THROW(test_uniform_ranks({100}, 99, 10), InputError);
}

}  // namespace
}  // namespace npdr::analysis
