#include "pipeline/sources/late_states.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

// Two rollouts of three steps.
Target recorded() {
  Target target{0.1, {{"q", "m"}}, {}, {}, "test"};
  for (const double first : {0.25, 1.5}) {
    RowMatrix states(4, 1);
    states << first, first + 1.0, first + 2.0, first + 3.0;
    target.rollouts.push_back({"r", states, RowMatrix(3, 0)});
  }
  return target;
}

// Two rows of them, `steps` later than right.
sim::Trajectories simulated(Index late) {
  sim::Trajectories x;
  x.resize(2, 2, 3, 1);
  for (Index i = 0; i < 2; ++i) {
    for (Index k = 0; k < 6; ++k) {
      const double first = k < 3 ? 0.25 : 1.5;
      const double value = first + static_cast<double>(k % 3 + 1 - late) * (1.0 + 0.1 * double(i));
      x.row(i)[static_cast<std::size_t>(k)] = static_cast<float>(value);
    }
  }
  return x;
}

TEST(LateStates, AreFoundInAllRows) {
  EXPECT_EQ(late_states(simulated(0), recorded()), "");
  EXPECT_NE(late_states(simulated(1), recorded()).find("all come a step late"), std::string::npos);
  sim::Trajectories mixed = simulated(1);
  mixed.row(1)[3] = 7.0f;
  EXPECT_EQ(late_states(mixed, recorded()), "");
}

TEST(LateStates, AreNoneOfWhatRestsAtFirst) {
  Target target = recorded();
  target.rollouts[1].states(1, 0) = target.rollouts[1].states(0, 0);
  EXPECT_EQ(late_states(simulated(1), target), "");
}

TEST(LateStates, DontCountFailures) {
  sim::Trajectories x = simulated(1);
  x.status[1] = sim::RolloutStatus::diverged;
  x.row(1)[0] = 9.0f;
  EXPECT_NE(late_states(x, recorded()), "");
  x.status[0] = sim::RolloutStatus::diverged;
  EXPECT_EQ(late_states(x, recorded()), "");
}

}  // namespace
}  // namespace npdr::pipeline
