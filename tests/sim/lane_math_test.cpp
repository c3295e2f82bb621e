#include "sim/lane_math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/constants.h"
#include "core/random.h"
#include "sim/lanes.h"

namespace npdr::sim {
namespace {

std::vector<double> uniform_values(double limit, std::size_t count) {
  Stream stream({1, "lane_math", 0, 0, 0});
  std::vector<double> values(count);
  for (double& v : values) v = limit * (2.0 * stream.uniform() - 1.0);
  return values;
}

// |computed - exact| in units of the spacing of doubles at the exact value.
double ulp_error(double computed, long double exact) {
  const double magnitude = std::abs(static_cast<double>(exact));
  const double spacing = std::nextafter(magnitude, kInfinity) - magnitude;
  return std::abs(static_cast<double>((static_cast<long double>(computed) - exact) / spacing));
}

// Evaluates in a loop over lanes, as the models do.
template <class Function>
auto of_lanes(const std::vector<double>& x, const Function& function) {
  std::vector<decltype(function(0.0))> result(x.size());
  for_each_lane(static_cast<Index>(x.size()), [&](Index i) {
    result[static_cast<std::size_t>(i)] = function(x[static_cast<std::size_t>(i)]);
  });
  return result;
}
std::vector<SinCos> sincos_of(const std::vector<double>& x) {
  return of_lanes(x, [](double v) { return lane_sincos(v); });
}
std::vector<double> tanh_of(const std::vector<double>& x) {
  return of_lanes(x, [](double v) { return lane_tanh(v); });
}
std::vector<double> exp_of(const std::vector<double>& x) {
  return of_lanes(x, [](double v) { return lane_exp(v); });
}

double worst_sincos_error(const std::vector<double>& x) {
  const std::vector<SinCos> computed = sincos_of(x);
  double worst = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto exact = static_cast<long double>(x[i]);
    worst = std::max({worst, ulp_error(computed[i].sin, std::sin(exact)),
                      ulp_error(computed[i].cos, std::cos(exact))});
  }
  return worst;
}

TEST(LaneMath, SineAndCosineAreExactToOneUlpUpToTheLargestAngle) {
  for (const double limit : {1e-8, 1.0, 10.0, 1e3, 1e5, kLargestAngle}) {
    EXPECT_LT(worst_sincos_error(uniform_values(limit, 100'000)), 1.0) << limit;
  }
}

TEST(LaneMath, SineAndCosineKeepTheirRelativeAccuracyNextToTheirZeros) {
  std::vector<double> x(80'000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<double>(i * 6) * std::numbers::pi / 2.0;
  }
  ASSERT_LT(x.back(), kLargestAngle);
  EXPECT_LT(worst_sincos_error(x), 1.0);
}

TEST(LaneMath, SineAndCosineOfWhatIsNoAngleAreNan) {
  const std::vector<double> x = {kNaN, kInfinity, -kInfinity, 1e6, -1e6, 1e300, -1e300, kNaN};
  for (const SinCos& v : sincos_of(x)) {
    EXPECT_TRUE(std::isnan(v.sin));
    EXPECT_TRUE(std::isnan(v.cos));
  }
}

TEST(LaneMath, HyperbolicTangentIsExactToFourUlpAndTheExponentialToOne) {
  for (const double limit : {1e-8, 0.3, 1.0, 5.0, 30.0, 708.0}) {
    const std::vector<double> x = uniform_values(limit, 100'000);
    const std::vector<double> tanh = tanh_of(x), exp = exp_of(x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto exact = static_cast<long double>(x[i]);
      ASSERT_LT(ulp_error(tanh[i], std::tanh(exact)), 4.0) << x[i];
      ASSERT_LT(ulp_error(exp[i], std::exp(exact)), 1.0) << x[i];
    }
  }
}

TEST(LaneMath, HyperbolicTangentHasItsLimits) {
  const std::vector<double> values =
      tanh_of({kInfinity, -kInfinity, 1e300, -1e300, 0.0, -0.0, 25.0, kNaN});
  EXPECT_EQ((std::vector<double>{values.begin(), values.begin() + 7}),
            (std::vector<double>{1.0, -1.0, 1.0, -1.0, 0.0, 0.0, 1.0}));
  EXPECT_TRUE(std::signbit(values[5]));
  EXPECT_TRUE(std::isnan(values[7]));
}

TEST(LaneMath, ExponentialHasItsLimits) {
  const std::vector<double> values =
      exp_of({-kInfinity, -1e300, -709.0, 0.0, -0.0, 710.0, kInfinity, kNaN});
  EXPECT_EQ((std::vector<double>{values.begin(), values.begin() + 7}),
            (std::vector<double>{0.0, 0.0, 0.0, 1.0, 1.0, kInfinity, kInfinity}));
  EXPECT_TRUE(std::isnan(values[7]));
}

TEST(LaneMath, WrappedAnglesAreNearestToZero) {
  constexpr double pi = std::numbers::pi;
  for (const double angle : {-3.1, -1.0, 0.0, 0.5, 3.1}) {
    for (const double turns : {-2.0, -1.0, 0.0, 1.0, 3.0}) {
      EXPECT_NEAR(lane_wrap(angle + 2.0 * pi * turns), angle, 1e-14) << turns;
    }
  }
  for (const double x : uniform_values(100.0, 1000)) {
    EXPECT_LE(std::abs(lane_wrap(x)), pi * (1.0 + 1e-14)) << x;
  }
  EXPECT_TRUE(std::isnan(lane_wrap(kNaN)));
  EXPECT_TRUE(std::isnan(lane_wrap(kInfinity)));
}

TEST(LaneMath, EveryLaneGetsTheSameBits) {
  for (const double x : uniform_values(50.0, 100)) {
    const std::vector<double> same(kLaneBlock, x);
    for (const SinCos& v : sincos_of(same)) {
      EXPECT_EQ(v.sin, sincos_of(same)[0].sin);
      EXPECT_EQ(v.cos, sincos_of(same)[0].cos);
    }
    for (const double v : tanh_of(same)) EXPECT_EQ(v, tanh_of(same)[0]);
    for (const double v : exp_of(same)) EXPECT_EQ(v, exp_of(same)[0]);
  }
}

}  // namespace
}  // namespace npdr::sim
