#include "pipeline/import/recording_warnings.h"

#include <cmath>
#include <numbers>

#include "core/text.h"
#include "sim/savitzky_golay.h"
#include "tests/message_of.h"
#include "tests/words_of.h"

namespace npdr::pipeline {
namespace {

// An angle that turns and swings, and its rate.
Target turning() {
  Target target{0.01, {{"alpha", "rad"}, {"alpha_dot", "rad/s"}}, {}, {}, "test"};
  for (const double phase : {0.0, 1.0}) {
    RowMatrix states(500, 2);
    for (Index t = 0; t < states.rows(); ++t) {
      const double time = 0.01 * static_cast<double>(t);
      states.row(t) << 2.0 * time + 0.5 * std::sin(3.0 * time + phase),
          2.0 + 1.5 * std::cos(3.0 * time + phase);
    }
    target.rollouts.push_back({phase == 0.0 ? "a" : "b", states, RowMatrix(499, 0)});
  }
  return target;
}

// The only one.
std::string warning(const Target& target) {
  const Findings all = warnings_of(target);
  EXPECT_EQ(all.size(), 1u) << words_of(all);
  return all.empty() ? "" : all.front().what;
}

TEST(RecordingWarnings, ThereAreNoneOfARightOne) {
  EXPECT_EQ(words_of(warnings_of(turning())), "");
}

TEST(RecordingWarnings, AnglesThatWrap) {
  Target target = turning();
  for (double& angle : target.rollouts[1].states.col(0)) {
    angle = std::remainder(angle, 2.0 * std::numbers::pi);
  }
  EXPECT_TRUE(says(warning(target), {"rollout b: alpha jumps by -6.249 after row", "it wraps"}));
}

TEST(RecordingWarnings, RatesInDegrees) {
  Target target = turning();
  for (Rollout& rollout : target.rollouts) rollout.states.col(1) *= 180.0 / std::numbers::pi;
  EXPECT_TRUE(has(warning(target), {"degrees", "in an HDF5 file, correct the numbers"}));
}

// By a window that is longer than a swing, whose rates are far too small.
TEST(RecordingWarnings, RatesInDegreesThatAreNamedOtherwise) {
  Target target = turning();
  target.state_channels[1].label = "alpha speed";
  EXPECT_EQ(words_of(warnings_of(target)), "");
  for (Rollout& rollout : target.rollouts) rollout.states.col(1) *= 180.0 / std::numbers::pi;
  EXPECT_TRUE(has(warning(target), "degrees"));
}

TEST(RecordingWarnings, ThereAreNoneOfComputedRates) {
  Target target = turning();
  target.dt = 0.004;
  for (Rollout& rollout : target.rollouts) {
    for (Index t = 0; t < rollout.states.rows(); ++t) {
      rollout.states(t, 0) = 0.5 * std::sin(50.0 * target.dt * static_cast<double>(t));
    }
    rollout.states.col(0) *= rollout.name == "a" ? 1.0 : 0.8;
    rollout.states.col(1) = sim::slopes(rollout.states.col(0), 51, target.dt);
    rollout.states(0, 1) = 0.0;
  }
  EXPECT_EQ(words_of(warnings_of(target)), "");
  for (Rollout& rollout : target.rollouts) rollout.states.col(1) *= 1.001;  // measured, then
  EXPECT_NE(words_of(warnings_of(target)), "");
}

TEST(RecordingWarnings, LeapsOfWhatHasNoMeasuredRate) {
  Target target = turning();
  for (Rollout& rollout : target.rollouts) {
    rollout.states.col(1) = sim::slopes(rollout.states.col(0), 11, target.dt);
  }
  auto& states = target.rollouts[1].states;
  states.col(0).tail(300).array() += 1.0;
  states.col(1) = sim::slopes(states.col(0), 11, target.dt);
  EXPECT_TRUE(says(warning(target), {"rollout b: alpha leaps by 1.03 in the step after 1.99 s"}));
}

TEST(RecordingWarnings, Copies) {
  Target target = turning();
  target.rollouts[1] = target.rollouts[0];
  target.rollouts[1].name = "b";
  EXPECT_TRUE(says(warning(target), {"rollout b holds the same numbers as rollout a"}));
}

}  // namespace
}  // namespace npdr::pipeline
