#include "core/target.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/error.h"
#include "tests/message_of.h"

namespace npdr {
namespace {

Target two_rollouts() {
  Target target;
  target.dt = 0.1;
  target.state_channels = {{"angle", "rad"}, {"rate", "rad/s"}};
  target.action_channels = {{"torque", "N m"}};
  for (const char* name : {"a", "b"}) {
    target.rollouts.push_back({name, RowMatrix::Ones(4, 2), RowMatrix::Zero(3, 1)});
  }
  return target;
}

std::string problem_of(const Target& target) {
  return message_of<InputError>([&] { target.check("file.h5"); });
}

TEST(Target, AcceptsAgreeingShapes) {
  EXPECT_EQ(problem_of(two_rollouts()), "");
  EXPECT_EQ(two_rollouts().num_steps(), 3);
}

TEST(Target, NamesTheNanItFinds) {
  Target target = two_rollouts();
  target.rollouts[1].states(2, 1) = kNaN;
  const std::string message = problem_of(target);
  EXPECT_TRUE(has(message, "file.h5: state of rollout 1 ('b') of channel 'rate' is nan at step 2"));
}

TEST(Target, RejectsStatesBeyondSinglePrecision) {
  Target target = two_rollouts();
  target.rollouts[1].actions(1, 0) = 1e300;
  EXPECT_EQ(problem_of(target), "");
  target.rollouts[1].states(2, 1) = -1e39;
  EXPECT_TRUE(says(problem_of(target),
                   {"file.h5: state of rollout 1 ('b') of channel 'rate' is -1e+39 at step 2",
                    "must be of magnitude 3.40282e+38 or less"}));
}

TEST(Target, RejectsAWrongShapeAndABadTimeStep) {
  Target target = two_rollouts();
  target.rollouts[0].actions.resize(2, 1);
  EXPECT_NE(problem_of(target), "");
  target = two_rollouts();
  target.dt = 0.0;
  EXPECT_TRUE(has(problem_of(target), "dt"));
  target.dt = kNaN;
  EXPECT_TRUE(has(problem_of(target), "dt"));
}

TEST(Target, FirstKeepsTheFirstRolloutsAndRejectsMoreThanThereAre) {
  EXPECT_EQ(two_rollouts().first(1).rollouts.front().name, "a");
  EXPECT_THROW(two_rollouts().first(3), InputError);
  EXPECT_THROW(two_rollouts().first(0), InputError);
}

TEST(Target, AfterKeepsTheOthersAndRejectsWhenNoneAreLeft) {
  const Target rest = two_rollouts().after(1);
  ASSERT_EQ(rest.num_rollouts(), 1);
  EXPECT_EQ(rest.rollouts.front().name, two_rollouts().rollouts.back().name);
  EXPECT_EQ(two_rollouts().after(0).num_rollouts(), 2);
  EXPECT_THROW(two_rollouts().after(2), InputError);
  EXPECT_THROW(two_rollouts().after(-1), InputError);
}

}  // namespace
}  // namespace npdr
