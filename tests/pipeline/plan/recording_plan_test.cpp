// Plans of studies on recordings.
#include <gtest/gtest.h>

#include "core/error.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/rollout_check.h"
#include "tests/message_of.h"
#include "tests/pipeline/plan/plan_parts.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

void write_constant(const std::filesystem::path& path, Index num_steps = 40) {
  const auto simulator = sim::make_simulator({.name = "pendulum"});
  Target target;
  target.dt = 0.02;
  target.state_channels = simulator->info().state_channels;
  target.action_channels = simulator->info().action_channels;
  for (const char* name : {"first", "second"}) {
    target.rollouts.push_back(
        {name, RowMatrix::Ones(num_steps + 1, 2), RowMatrix::Zero(num_steps, 1)});
  }
  write_recording(target, path);
}

TEST(Plan, AFloorIsSearchedForRecordingsOnly) {
  const TempFolder folder;
  write_constant(folder / "r.h5");
  const std::string recording = "target.recording=" + (folder / "r.h5").string();
  const auto baseline = [](const std::vector<std::string>& overrides) {
    return keys(plan_of(overrides), Stage::baseline);
  };
  EXPECT_EQ(baseline({"evaluate.floor=false"}), baseline({}));
  EXPECT_NE(baseline({recording, "evaluate.floor=false"}), baseline({recording}));
}

TEST(Plan, AStudyPicksRolloutsOfItsRecording) {
  const TempFolder folder;
  write_constant(folder / "r.h5");
  const auto plan = [&](const std::string& rollouts) {
    return plan_of({"target.recording=" + (folder / "r.h5").string(), "target.num_rollouts=1",
                    "target.held_out=1", "target.rollouts=" + rollouts});
  };
  EXPECT_EQ(names_of(plan("[2, 1]").target), "secondfirst");
  EXPECT_EQ(keys(plan("[1, 2]"), Stage::report), keys(plan("[1, 2]"), Stage::report));
  EXPECT_TRUE(says(message_of<InputError>([&] { plan("[1]"); }),
                   {"--set target.held_out=1: target.held_out = 1", "must be <= 0"}));
  EXPECT_TRUE(says(message_of<InputError>([&] { plan("[1, 3]"); }),
                   {"--set target.rollouts=[1, 3]: target.rollouts = 3",
                    "must be <= 2, what the recording holds"}));
}

TEST(Plan, ARefinementThatLeavesRolloutsOutNeedsTwo) {
  const TempFolder folder;
  write_constant(folder / "r.h5");
  const std::string text =
      StudyText("one")
          .with("target", {"recording = \"" + (folder / "r.h5").string() + "\""})
          .with("simulator", {"name = \"pendulum\""})
          .with("prior", {"pole_mass = { uniform = [0.3, 1.7] }"})
          .with("observation_noise", {"scale = 0.1"})
          .method("A", {"algorithm = \"refine\"", "refine = { cross_validate = true }"});
  const auto plan = [&](const std::string& rollouts) {
    make_plan(parse_study(text, "one.toml", {"target.rollouts=" + rollouts}), WorkFolder("runs"));
  };
  EXPECT_NO_THROW(plan("[2, 1]"));
  EXPECT_TRUE(has(message_of<InputError>([&] { plan("[2]"); }),
                  "refine.cross_validate = true, must be false with a single rollout"));
}

TEST(Plan, AChannelThatIsZeroThroughoutIsNamed) {
  const TempFolder folder;
  write_constant(folder / "r.h5");
  Plan plan = plan_of({"target.recording=" + (folder / "r.h5").string()});
  EXPECT_NO_THROW(require_motion(plan.study, plan.target));
  plan.target.rollouts[1].states.col(1).head(40).setZero();  // but for the last, which isn't
                                                             // replayed
  EXPECT_TRUE(says(message_of<InputError>([&] { require_motion(plan.study, plan.target); }),
                   {"--set target.recording=", "channel 'theta_dot' of rollout 'second' is 0",
                    "leave out the rollout (target.rollouts)"}));
  plan.target.rollouts[1].states.col(1).setZero();
  plan.target.rollouts[1].states(0, 1) = 1.0;  // the first one, of which there is no noise
  EXPECT_THROW(require_motion(plan.study, plan.target), InputError);
}

TEST(Plan, ARecordingHasTwoStepsAtLeast) {
  const TempFolder folder;
  write_constant(folder / "r.h5", 1);
  const std::string recording = "target.recording=" + (folder / "r.h5").string();
  EXPECT_TRUE(says(message_of<InputError>([&] {
                     plan_of({recording, "target.num_rollouts=1"});
                   }),
                   {"--set target.recording=",
                    "target.recording = one of a single step, must be a recording of 2 steps"}));
}

TEST(Plan, SaysWhereAStudyDoesntFitItsRecording) {
  const TempFolder folder;
  write_constant(folder / "r.h5");
  const auto problems = [&](const std::vector<std::string>& more) {
    std::vector<std::string> overrides = {"target.recording=" + (folder / "r.h5").string()};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return message_of<InputError>([&] { plan_of(overrides); });
  };
  EXPECT_TRUE(says(problems({"target.num_rollouts=3"}),
                   {"--set target.num_rollouts=3: target.num_rollouts = 3", "must be <= 2"}));
  EXPECT_TRUE(says(problems({"evaluate.leave_out=3"}),
                   {"--set evaluate.leave_out=3: evaluate.leave_out = 3",
                    "must be <= 2, the rollouts that inference sees"}));
  EXPECT_TRUE(says(problems({"evaluate.leave_out=2", "method.B.num_rollouts=2"}),
                   {"--set method.B.num_rollouts=2: method.num_rollouts = 2",
                    "must be <= 1, the rollouts of the target but those that a fold leaves out"}));
  EXPECT_TRUE(says(problems({"method.B.num_rollouts=3"}),
                   {"--set method.B.num_rollouts=3: method.num_rollouts = 3", "must be <= 2"}));
  EXPECT_TRUE(says(problems({"method.A.embedding.downsample=21"}),
                   {"--set method.A.embedding.downsample=21: method.embedding.downsample = 21",
                    "must be <= 20"}));
  EXPECT_TRUE(
      problems({"simulator.store_every=41", "method.embedding.downsample=41"})
          .starts_with("--set simulator.store_every=41: simulator.store_every = 41, must "
                       "be <= 20, so that two of the 40 states of a rollout are left\n--set "
                       "method.embedding"));
  const std::string text = two_methods().method("C", {"embedding = { downsample = 30 }"});
  EXPECT_TRUE(says(message_of<InputError>([&] {
                     make_plan(parse_study(text, "two.toml",
                                           {"target.recording=" + (folder / "r.h5").string()}),
                               WorkFolder("runs"));
                   }),
                   {"two.toml:23:28: method.embedding.downsample = 30", "must be <= 20"}));
}

}  // namespace
}  // namespace npdr::pipeline
