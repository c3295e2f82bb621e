#include "inference/diagnostics/bound_pressure.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/normal.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

// Samples of N(mean, s^2) between the bounds 0 and 1, by the inverse of its distribution function.
Vector cut_gaussian(double mean, double s, Stream& stream) {
  const double low = normal_cdf(-mean / s), high = normal_cdf((1.0 - mean) / s);
  Vector v(1000);
  for (double& value : v) {
    value = mean + s * normal_quantile(low + stream.uniform() * (high - low));
  }
  return v;
}

Stream stream_of(std::uint64_t row) { return Stream({1, "bounds", 0, row, 0}); }

TEST(BoundPressure, FindsTruthsBeyondTheBound) {
  for (const double beyond : {2.0, 3.0, 5.0}) {
    Stream stream = stream_of(0);
    const double s = 0.03;
    EXPECT_TRUE(test_bounds(cut_gaussian(-beyond * s, s, stream)).presses_lower()) << beyond;
    EXPECT_TRUE(test_bounds(cut_gaussian(1.0 + beyond * s, s, stream)).presses_upper()) << beyond;
  }
}

// Where a network knows the prior as a Gaussian, its samples come near to the bound, not to it.
TEST(BoundPressure, FindsSamplesThatLeaveAGap) {
  Stream stream = stream_of(0);
  Vector v(1000);
  for (double& value : v) value = normal_cdf(-4.0 + 0.2 * stream.normal());
  EXPECT_TRUE(test_bounds(v).presses_lower());
  EXPECT_FALSE(test_bounds(v).presses_upper());
  EXPECT_TRUE(test_bounds(1.0 - v.array()).presses_upper());
}

TEST(BoundPressure, FindsAFewSamplesThatHaveLeaked) {
  Stream stream = stream_of(0);
  Vector v = cut_gaussian(0.5, 0.3, stream);
  v.head(20).setConstant(1e-9);  // of 1000
  EXPECT_TRUE(test_bounds(v).leaks_lower());
  EXPECT_TRUE(test_bounds(v).presses_lower());
  EXPECT_FALSE(test_bounds(v).presses_upper());
  EXPECT_TRUE(test_bounds(1.0 - v.array()).leaks_upper());
  v.head(20).setConstant(1e-4);
  EXPECT_FALSE(test_bounds(v).presses_lower());
}

TEST(BoundPressure, FindsNothingInThePriorNorWellInside) {
  Stream stream = stream_of(0);
  Vector prior(1000);
  for (double& value : prior) value = stream.uniform();
  for (const Vector& v : {prior, cut_gaussian(0.1, 0.05, stream), cut_gaussian(0.5, 0.3, stream)}) {
    const BoundPressure found = test_bounds(v);
    EXPECT_FALSE(found.presses_lower() || found.presses_upper());
    EXPECT_FALSE(found.leaks_lower() || found.leaks_upper());
  }
}

// Exact posteriors of truths that the prior holds: the rates that the header tells, 0.17 s, and at
// most 0.011 more, with five standard errors of 4000 trials (false alarms: 6e-7); fixed seed.
TEST(BoundPressure, RarelyAccusesAPriorThatHoldsTheTruth) {
  constexpr int trials = 4000;
  for (const double s : {0.01, 0.05, 0.1}) {
    int alarms = 0;
    for (int trial = 0; trial < trials; ++trial) {
      Stream stream = stream_of(static_cast<std::uint64_t>(trial));
      const double truth = stream.uniform();
      const double observed = truth + s * stream.normal();
      const BoundPressure found = test_bounds(cut_gaussian(observed, s, stream));
      alarms += found.presses_lower() || found.presses_upper() ? 1 : 0;
    }
    const double rate = 0.17 * s, most = rate + 0.011;
    EXPECT_LT(static_cast<double>(alarms) / trials, most + 5.0 * std::sqrt(most / trials)) << s;
    EXPECT_GT(static_cast<double>(alarms) / trials, rate - 5.0 * std::sqrt(rate / trials)) << s;
  }
}

TEST(BoundPressure, RejectsTooFewSamples) {
  EXPECT_THROW(test_bounds(Vector::Zero(kFewestForBounds - 1)), InputError);
}

}  // namespace
}  // namespace npdr::inference
