#include "analysis/ensembles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"

namespace npdr::analysis {
namespace {

constexpr Index kRollouts = 2, kSteps = 7, kStates = 3;  // 42 states: one block and a part of one

class Ensembles : public testing::TestWithParam<Index> {
 protected:
  Ensembles() : values_(static_cast<std::size_t>(GetParam() * kRollouts * kSteps * kStates)) {
    Stream stream({1, "ensembles_test"});
    // Few values, so that many are equal.
    for (float& v : values_) v = static_cast<float>(stream.below(20)) - 10.0f;
  }

  TrajectoryView view() const { return {values_, GetParam(), kRollouts, kSteps, kStates}; }
  // All but the second sample.
  std::vector<Index> samples() const {
    std::vector<Index> chosen;
    for (Index i = 0; i < GetParam(); ++i) {
      if (i != 1) chosen.push_back(i);
    }
    return chosen;
  }
  std::vector<double> expected(const Place& at) const {
    std::vector<double> states;
    for (const Index i : samples()) {
      states.push_back(double{view().rollout(i, at.rollout)(at.time, at.channel)});
    }
    return states;
  }

  std::vector<float> values_;
};

TEST_P(Ensembles, HoldEachStateOfTheChosenSamplesOnce) {
  RowMatrixX<int> visits = RowMatrixX<int>::Zero(kRollouts * kSteps, kStates);
  for_each_ensemble(view(), samples(), [&](const Place& at, std::span<double> ensemble) {
    EXPECT_EQ(at.row, at.rollout * kSteps + at.time);
    ++visits(at.row, at.channel);
    EXPECT_EQ(std::vector<double>(ensemble.begin(), ensemble.end()), expected(at));
  });
  EXPECT_TRUE((visits.array() == 1).all());
}

TEST_P(Ensembles, AreSortedAsTheStandardLibraryDoes) {
  for_each_sorted_ensemble(view(), samples(), [&](const Place& at, std::span<double> sorted) {
    std::vector<double> states = expected(at);
    std::ranges::sort(states);
    EXPECT_EQ(std::vector<double>(sorted.begin(), sorted.end()), states);
  });
}

INSTANTIATE_TEST_SUITE_P(OfSizes, Ensembles, testing::Range<Index>(0, 70));

}  // namespace
}  // namespace npdr::analysis
