#include "analysis/ensembles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"

namespace npdr::analysis {
namespace {

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
