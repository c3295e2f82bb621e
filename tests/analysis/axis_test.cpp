#include "analysis/axis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

using Labels = std::vector<std::string>;

TEST(Axis, ScalesByAPowerOfTenWhereLabelsWouldBeLong) {
  const Axis damping = make_axis({0.0, 1e-3}, "", "N m s/rad");
  EXPECT_DOUBLE_EQ(damping.scale, 1e3);
  EXPECT_EQ(damping.unit, "[10⁻³ N m s/rad]");
  EXPECT_EQ(damping.labels, (Labels{"0.4", "0.8"}));
  const Axis mass = make_axis({0.066, 0.12}, "", "kg");
  EXPECT_EQ(mass.scale, 1.0);
  EXPECT_EQ(mass.unit, "[kg]");
  EXPECT_EQ(mass.labels, (Labels{"0.08", "0.10"}));
  EXPECT_EQ(make_axis({0.0, 2.5e12}, "", "1").unit, "[10¹²]");
  EXPECT_EQ(make_axis({0.0, 1.0}, "", "1").unit, "");
  EXPECT_EQ(make_axis({0.0, 1.0}, "", "").unit, "");
}

TEST(Axis, KeepsTicksOffTheEndsUnlessTheyMayBeThere) {
  EXPECT_EQ(make_axis({-0.08, 0.08}, "", "m").labels, (Labels{"-5", "0", "5"}));
  EXPECT_EQ(make_axis({0.0, 5.0}, "", "s", 3).labels, (Labels{"1", "2", "3", "4"}));
  EXPECT_EQ(make_axis({0.0, 1.0}, "", "", 3, 0.0).labels, (Labels{"0.0", "0.5", "1.0"}));
}

TEST(Axis, HasEnoughTicksInsideAnyRange) {
  for (const double lower : {-3.2, 0.0, 1e-7, 41.0, 1e5}) {
    for (const double range : {1e-7, 0.003, 0.7, 1.0, 9.9, 1e6}) {
      const Axis axis = make_axis({lower, lower + range}, "", "m");
      ASSERT_GE(axis.ticks.size(), 2u) << lower << " " << range;
      EXPECT_LE(axis.ticks.size(), 9u) << lower << " " << range;
      EXPECT_GT(axis.ticks.front(), lower * axis.scale);
      EXPECT_LT(axis.ticks.back(), (lower + range) * axis.scale);
      EXPECT_EQ(axis.labels.size(), axis.ticks.size());
    }
  }
}

TEST(Axis, ComesToAnEndWhereDoublesHardlyTellItsEndsApart) {
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(make_axis({0.0, 1e-310}, "", "kg").unit, "[10⁻³⁰⁰ kg]");
  EXPECT_LE(make_axis({0.0, tiny}, "", "kg").ticks.size(), 9u);
  for (const double value : {1.0, 1e17, 1e-300, 1e300}) {
    const Axis axis = make_axis({value, std::nextafter(value, 2.0 * value)}, "", "kg");
    EXPECT_LE(axis.ticks.size(), 9u) << value;
  }
}

TEST(Range, HoldsTheFiniteValues) {
  Range range;
  range.add((Vector(4) << 3.0, -1.0, kInfinity, kNaN).finished());
  EXPECT_EQ(range.lower, -1.0);
  EXPECT_EQ(range.upper, 3.0);
  EXPECT_EQ(range.widened(0.25).lower, -2.0);
  EXPECT_EQ(range.widened(0.25).upper, 4.0);
}

TEST(Range, OfOneValueOrNoneCanBeShown) {
  EXPECT_EQ(Range{}.widened(0.1).upper, 1.0);
  for (const double value : {0.0, -5.0, 1e9}) {
    const Range range = Range{value, value}.widened(0.1);
    EXPECT_LT(range.lower, value);
    EXPECT_GT(range.upper, value);
  }
}

TEST(Axis, RejectsEmptyAndInfiniteRanges) {
  EXPECT_THROW(make_axis({1.0, 1.0}, "", "m"), InputError);
  EXPECT_THROW(make_axis({0.0, kInfinity}, "", "m"), InputError);
  EXPECT_THROW(make_axis({kNaN, 1.0}, "", "m"), InputError);
}

}  // namespace
}  // namespace npdr::analysis
