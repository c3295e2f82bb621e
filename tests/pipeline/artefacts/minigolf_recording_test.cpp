#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/artefacts/recording.h"
#include "sim/minigolf/arm.h"
#include "tests/device_recordings.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

sim::JointAngles joints(const RowMatrix& values, Index t) {
  sim::JointAngles q;
  std::copy_n(values.row(t).data() + values.cols() - Index(q.size()), q.size(), q.begin());
  return q;
}

// The club's head begins where Table A4's strike does, to what the robot's controller leaves.
void expect_strikes(const Target& recorded) {
  const Eigen::Vector3d start = sim::head_pose(sim::strike(0.0)).translation();
  for (const Rollout& rollout : recorded.rollouts) {
    const Eigen::Vector3d tip = sim::head_pose(joints(rollout.actions, 0)).translation();
    EXPECT_LT((tip - start).norm(), 2e-3) << rollout.name;
    EXPECT_GT(rollout.states(recorded.num_steps(), 0), rollout.states(0, 0) + 0.3) << rollout.name;
  }
}

Channels golf_channels() { return channels_of(sim::make_simulator({.name = "minigolf"})->info()); }

// It holds the joints' angles, too, before the ball's position.
TEST(MinigolfRecording, HoldsStrikesAndMore) {
  const TempFolder folder;
  const Target target = minigolf_recording(3);
  Target wide = target;
  for (int joint = 7; joint >= 1; --joint) {
    wide.state_channels.insert(wide.state_channels.begin(), {"q" + std::to_string(joint), "rad"});
  }
  for (Rollout& rollout : wide.rollouts) {
    const Index steps = rollout.num_steps();
    RowMatrix states(steps + 1, 9);
    states << RowMatrix::Zero(steps + 1, 7), rollout.states;
    states.topLeftCorner(steps, 7) = rollout.actions;
    rollout.states = states;
  }
  write_recording(wide, folder / "wide.h5");
  EXPECT_EQ(read_recording(folder / "wide.h5").num_states(), 9);
  const Target recorded = read_recording(folder / "wide.h5", golf_channels());
  EXPECT_EQ(content_hash(recorded), content_hash(target));
  expect_strikes(recorded);
}

// Largest distance [m] of the ball from the recorded ones at rest.
double final_error(const Target& recorded, const std::map<std::string, double>& parameters) {
  const auto simulator = sim::make_simulator({.name = "minigolf"});
  const RowMatrix theta = sim::complete_theta(*simulator, parameters).transpose();
  const sim::Trajectories found = simulator->replay(recorded, theta);
  EXPECT_EQ(found.status.front(), sim::RolloutStatus::ok);
  double worst = 0.0;
  for (Index h = 0; h < recorded.num_rollouts(); ++h) {
    const Index last = recorded.num_steps();
    const auto& states = recorded.rollouts[static_cast<std::size_t>(h)].states;
    worst = std::max(worst, std::hypot(found.rollout(0, h)(last - 1, 0) - states(last, 0),
                                       found.rollout(0, h)(last - 1, 1) - states(last, 1)));
  }
  return worst;
}

TEST(MinigolfRecording, IsReplayedByTheParametersThatMadeIt) {
  const TempFolder folder;
  write_recording(minigolf_recording(3), folder / "a.h5");
  const Target recorded = read_recording(folder / "a.h5", golf_channels());
  // Stored states have single precision.
  EXPECT_LT(final_error(recorded, kGolfDevice), 1e-6);
  EXPECT_GT(final_error(recorded, {}), 0.05);
}

}  // namespace
}  // namespace npdr::pipeline
