#include "sim/trajectories.h"

#include <gtest/gtest.h>

#include <numeric>

namespace npdr::sim {
namespace {

TEST(Trajectories, HoldRowsRolloutsStepsAndStatesInThisOrder) {
  Trajectories trajectories;
  trajectories.resize(2, 3, 4, 5);
  std::iota(trajectories.values.begin(), trajectories.values.end(), 0.0f);
  EXPECT_EQ(trajectories.row_size(), 60);
  EXPECT_EQ(trajectories.row(1).front(), 60.0f);
  EXPECT_EQ(trajectories.row(1).size(), 60u);
  // Element (1, 2, 3, 4) is the last one.
  EXPECT_EQ(trajectories.rollout(1, 2)(3, 4), 119.0f);
  EXPECT_EQ(trajectories.rollout(0, 1)(0, 0), 20.0f);
}

TEST(Trajectories, StatusHasAName) {
  EXPECT_EQ(to_string(RolloutStatus::ok), "ok");
  EXPECT_EQ(to_string(RolloutStatus::diverged), "diverged");
  EXPECT_EQ(to_string(RolloutStatus::out_of_limits), "out_of_limits");
}

}  // namespace
}  // namespace npdr::sim
