// Ensembles of simulated states, and their quantiles.

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/ensembles.h"
#include "analysis/quantiles.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "tests/thread_count.h"

namespace npdr::analysis {
namespace {

// 11 samples of one rollout of two steps of one channel: 0, ..., 10 at the first step and ten times
// that at the second. The 5 % quantile is at position 0.5, the 95 % quantile at 9.5.
TEST(Quantiles, OfTrajectoriesArePointwise) {
  std::vector<float> values;
  for (const int k : {3, 0, 10, 7, 5, 1, 9, 2, 8, 4, 6}) {
    values.push_back(static_cast<float>(k));
    values.push_back(static_cast<float>(10 * k));
  }
  const Bands bands = quantile_bands({values, 11, 1, 2, 1});
  EXPECT_EQ(bands.num_samples, 11);
  EXPECT_DOUBLE_EQ(bands.lower[0](0, 0), 0.5);
  EXPECT_DOUBLE_EQ(bands.median[0](0, 0), 5.0);
  EXPECT_DOUBLE_EQ(bands.upper[0](0, 0), 9.5);
  EXPECT_DOUBLE_EQ(bands.lower[0](1, 0), 5.0);
  EXPECT_DOUBLE_EQ(quantile_bands({values, 11, 1, 2, 1}, 0.8).upper[0](0, 0), 9.0);
}

TEST(Quantiles, KeepRolloutsAndChannelsApart) {
  // One sample (H, T, C) = (2, 2, 3) with the value 100 h + 10 t + c.
  std::vector<float> values;
  for (const int h : {0, 1}) {
    for (const int t : {0, 1}) {
      for (const int c : {0, 1, 2}) values.push_back(static_cast<float>(100 * h + 10 * t + c));
    }
  }
  const Bands bands = quantile_bands({values, 1, 2, 2, 3});
  EXPECT_EQ(bands.median[0](1, 2), 12.0);
  EXPECT_EQ(bands.lower[1](0, 1), 101.0);
  EXPECT_EQ(bands.upper[1](1, 0), 110.0);
}

TEST(Quantiles, LeaveOutFailedSamples) {
  std::vector<float> values = {1.0f, 1.0f, 5.0f, kFloatNaN};
  const Bands bands = quantile_bands({values, 2, 1, 2, 1});
  EXPECT_EQ(bands.num_samples, 1);
  EXPECT_EQ(bands.median[0](0, 0), 1.0);
  values[0] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(std::isnan(quantile_bands({values, 2, 1, 2, 1}).median[0](0, 0)));
}

TEST(Quantiles, SameBitsForAnyThreadCount) {
  std::vector<float> values(50 * 2 * 30 * 3);
  Stream({1, "quantiles_test"}).fill_normal(values);
  expect_same_for_any_thread_count([&] {
    const Bands bands = quantile_bands({values, 50, 2, 30, 3});
    return std::vector{bands.lower, bands.median, bands.upper};
  });
}

TEST(Quantiles, RejectWrongShapesAndCoverages) {
  const std::vector<float> values(12);
  EXPECT_THROW(quantile_bands({values, 1, 1, 5, 2}), ShapeError);
  EXPECT_THROW(quantile_bands({values, 1, 1, 6, 2}, 1.0), InputError);
}

constexpr Index kRollouts = 2, kSteps = 7, kStates = 3;  // 42 states: one block and a part of one

// n samples with few values, so that many are equal.
struct Simulated {
  explicit Simulated(Index n) : values(static_cast<std::size_t>(n * kRollouts * kSteps * kStates)) {
    Stream stream({1, "ensembles_test"});
    for (float& v : values) v = static_cast<float>(stream.below(20)) - 10.0f;
    view = {values, n, kRollouts, kSteps, kStates};
    for (Index i = 0; i < n; ++i) {
      if (i != 1) chosen.push_back(i);
    }
  }
  std::vector<double> at(const Place& place) const {
    std::vector<double> states;
    for (const Index i : chosen) {
      states.push_back(double{view.rollout(i, place.rollout)(place.time, place.channel)});
    }
    return states;
  }

  std::vector<float> values;
  TrajectoryView view;
  std::vector<Index> chosen;  // all samples but the second
};

std::vector<double> copy_of(std::span<const double> values) {
  return {values.begin(), values.end()};
}

TEST(Ensembles, HoldEachStateOfTheChosenSamplesOnce) {
  for (const Index n : {0, 1, 2, 5}) {
    const Simulated simulated(n);
    RowMatrixX<int> visits = RowMatrixX<int>::Zero(kRollouts * kSteps, kStates);
    for_each_ensemble(simulated.view, simulated.chosen,
                      [&](const Place& at, std::span<double> ensemble) {
                        EXPECT_EQ(at.row, at.rollout * kSteps + at.time);
                        ++visits(at.row, at.channel);
                        EXPECT_EQ(copy_of(ensemble), simulated.at(at));
                      });
    EXPECT_TRUE((visits.array() == 1).all()) << n;
  }
}

TEST(Ensembles, AreSortedAsTheStandardLibraryDoes) {
  for (Index n = 0; n < 70; ++n) {
    const Simulated simulated(n);
    for_each_sorted_ensemble(simulated.view, simulated.chosen,
                             [&](const Place& at, std::span<double> sorted) {
                               std::vector<double> expected = simulated.at(at);
                               std::ranges::sort(expected);
                               EXPECT_EQ(copy_of(sorted), expected) << n;
                             });
  }
}

}  // namespace
}  // namespace npdr::analysis
