#include "analysis/number_text.h"

#include <gtest/gtest.h>

#include "core/constants.h"

namespace npdr::analysis {
namespace {

std::string plain(double mean, double std) { return mean_std_text(mean, std, NumberStyle::plain); }

TEST(NumberText, WritesThePublishedFiguresAsThePaperDoes) {
  EXPECT_EQ(plain(0.263, 0.004), "0.263 ± 0.004");
  EXPECT_EQ(plain(0.274, 0.021), "0.274 ± 0.021");
  EXPECT_EQ(plain(1070.0, 30.0), "[1.07 ± 0.03]e+3");
  EXPECT_EQ(plain(0.745, 1e-16), "0.745 ± 0.000") << "equal numbers";
  EXPECT_EQ(mean_std_text(0.263, 0.004, NumberStyle::latex), "$0.263 \\pm 0.004$");
  EXPECT_EQ(mean_std_text(1070.0, 30.0, NumberStyle::latex), "$[1.07 \\pm 0.03]\\mathrm{e}{+}3$");
}

TEST(NumberText, ScalesTheSmallAndTheLarge) {
  EXPECT_EQ(plain(1e-6, 2e-7), "[1.00 ± 0.20]e-6");
  EXPECT_EQ(plain(-2.5e4, 400.0), "[-2.50 ± 0.04]e+4");
  EXPECT_EQ(plain(490.3, 11.9), "490 ± 12");
  EXPECT_EQ(plain(-2464.538, 0.021), "-2464.54 ± 0.02");
  EXPECT_EQ(plain(2464.0, 1.0), "[2.464 ± 0.001]e+3");
  EXPECT_EQ(plain(0.00123, 0.0004), "0.00123 ± 0.00040");
  EXPECT_EQ(mean_std_text(1e-6, 2e-7, NumberStyle::latex), "$[1.00 \\pm 0.20]\\mathrm{e}{-}6$");
}

TEST(NumberText, DigitsFollowTheLargerAndStillShowTheSpread) {
  EXPECT_EQ(plain(0.263, 1e-5), "0.26300 ± 0.00001");
  EXPECT_EQ(plain(0.001, 2.5), "0.00 ± 2.50");
  EXPECT_EQ(plain(12.3, 1400.0), "[0.01 ± 1.40]e+3");
  EXPECT_EQ(plain(1e6, 1e-8), "[1.00000000 ± 0.00000000]e+6");
  EXPECT_EQ(plain(0.0, 0.0), "0.00 ± 0.00");
}

// 999.7 has three digits before rounding and four after.
TEST(NumberText, RoundsBeforeItCountsDigits) {
  EXPECT_EQ(plain(999.7, 30.0), "[1.00 ± 0.03]e+3");
  EXPECT_EQ(plain(9.999, 0.1), "10.0 ± 0.1");
  EXPECT_EQ(number_text(99999.6, NumberStyle::plain), "1e5");
}

TEST(NumberText, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(plain(0.263, kNaN), "0.263");
  EXPECT_EQ(plain(7.26e-4, kNaN), "7.26e-4");
  EXPECT_EQ(mean_std_text(1070.0, kNaN, NumberStyle::latex), "$1.07\\mathrm{e}{+}3$");
  EXPECT_EQ(plain(kNaN, 0.1), "n/a");
  EXPECT_EQ(number_text(kNaN, NumberStyle::plain), "n/a");
  EXPECT_EQ(number_text(-kInfinity, NumberStyle::plain), "-inf");
  EXPECT_EQ(number_text(kInfinity, NumberStyle::latex), "$\\infty$");
}

TEST(NumberText, WritesPlainNumbersShort) {
  const auto text = [](double value) { return number_text(value, NumberStyle::plain); };
  EXPECT_EQ(text(5000.0), "5000");
  EXPECT_EQ(text(-0.0), "0");
  EXPECT_EQ(text(8.4), "8.4");
  EXPECT_EQ(text(1234.56), "1235");
  EXPECT_EQ(text(2.9e-4), "2.9e-4");
  EXPECT_EQ(text(1234567.0), "1.235e6");
  EXPECT_EQ(number_text(2.9e-4, NumberStyle::latex), "$2.9 \\times 10^{-4}$");
  EXPECT_EQ(number_text(8.4, NumberStyle::latex), "$8.4$");
}

}  // namespace
}  // namespace npdr::analysis
