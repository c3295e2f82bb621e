#include "inference/diagnostics/uniformity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace npdr::inference {
namespace {

Vector uniforms(Index n, std::uint64_t seed) {
  Stream stream({seed, "uniforms", 0, 0, 0});
  return Vector::NullaryExpr(n, [&](Index) { return stream.uniform(); });
}

// Tabled quantiles of chi^2: 3.841 is the 95 % point for one degree of freedom.
TEST(Uniformity, PValueIsTheChiSquareTail) {
  Vector values(100);  // 60 and 40 of 100: chi^2 = 4, p = 0.0455003
  values << Vector::Constant(60, 0.2), Vector::Constant(40, 0.7);
  const ChiSquare test = test_chi_square(values, 2);
  EXPECT_EQ(test.counts, (std::vector<Index>{60, 40}));
  EXPECT_DOUBLE_EQ(test.statistic, 4.0);
  EXPECT_NEAR(test.p_value, 0.0455003, 1e-6);
}

// Tabled: P(D >= 0.410) = 0.05 and P(D >= 0.490) = 0.01 for n = 10; 1.3581 / sqrt(n) and
// 1.6276 / sqrt(n) for large n. The approximation is good to a few percent of p.
TEST(Uniformity, PValueIsKolmogorovsTail) {
  const auto p_of = [](Index n, double distance) {
    // Equally spaced, then pushed up: the largest distance is above the first value.
    Vector values =
        Vector::LinSpaced(n, 0.5, static_cast<double>(n) - 0.5) / static_cast<double>(n);
    values.array() += distance - 0.5 / static_cast<double>(n);
    return test_kolmogorov_smirnov(values.cwiseMin(1.0)).p_value;
  };
  EXPECT_NEAR(p_of(10, 0.410), 0.05, 0.002);
  EXPECT_NEAR(p_of(10, 0.490), 0.01, 0.0006);
  EXPECT_NEAR(p_of(10'000, 0.013581), 0.05, 0.001);
  EXPECT_NEAR(p_of(10'000, 0.016276), 0.01, 0.0003);
}

// A share of 5 % of 400 samples has p < 0.05; four standard errors are 4.4 % (false-alarm rate
// 6e-5).
TEST(Uniformity, FalseAlarmsAreAsFrequentAsTheySay) {
  double smirnov = 0.0, chi_square = 0.0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const Vector values = uniforms(100, seed);
    smirnov += test_kolmogorov_smirnov(values).p_value < 0.05 ? 1.0 / 400.0 : 0.0;
    chi_square += test_chi_square(values, 5).p_value < 0.05 ? 1.0 / 400.0 : 0.0;
  }
  const double tolerance = 4.0 * std::sqrt(0.05 * 0.95 / 400.0);
  EXPECT_NEAR(smirnov, 0.05, tolerance);
  EXPECT_NEAR(chi_square, 0.05, tolerance);
}

TEST(Uniformity, SpreadRanksFillTheUnitInterval) {
  const Vector spread = spread_ranks({0, 3, 9}, 9, {1, "spread", 0, 0, 0});
  for (Index i = 0; i < 3; ++i) {
    const double rank = i == 0 ? 0.0 : i == 1 ? 3.0 : 9.0;
    EXPECT_GT(spread(i), rank / 10.0);
    EXPECT_LT(spread(i), (rank + 1.0) / 10.0);
  }
  EXPECT_EQ(spread_ranks({0, 3}, 9, {1, "spread", 0, 0, 0}), spread.head(2));
}

TEST(Uniformity, RejectsWhatIsNoRankOrLevel) {
  EXPECT_THROW(spread_ranks({10}, 9, {}), InputError);
  EXPECT_THROW(spread_ranks({-1}, 9, {}), InputError);
  EXPECT_THROW(test_kolmogorov_smirnov(Vector()), InputError);
  EXPECT_THROW(test_kolmogorov_smirnov(Vector::Constant(3, 1.5)), InputError);
  EXPECT_THROW(test_chi_square(Vector::Constant(3, std::nan("")), 2), InputError);
  EXPECT_THROW(test_chi_square(Vector::Constant(3, 0.5), 1), InputError);
}

}  // namespace
}  // namespace npdr::inference
