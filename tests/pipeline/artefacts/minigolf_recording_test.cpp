#include <gtest/gtest.h>

#include "pipeline/artefacts/recording.h"
#include "sim/minigolf/arm.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::filesystem::path kReal =
    std::filesystem::path(NPDR_SOURCE_DIR) / "../shared/data/real/minigolf_8s.h5";

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

TEST(MinigolfRecording, HoldsStrikes) {
  if (!std::filesystem::exists(kReal)) GTEST_SKIP() << "no recordings at " << kReal;
  const Target recorded = read_recording(kReal, golf_channels());
  EXPECT_EQ(recorded.num_rollouts(), 7);
  EXPECT_EQ(recorded.num_steps(), 800);
  expect_strikes(recorded);
}

// It holds the joints' angles, too: where they put the club's head, the commanded ones do.
TEST(MinigolfRecording, CommandsAreTheJointsAngles) {
  if (!std::filesystem::exists(kReal)) GTEST_SKIP() << "no recordings at " << kReal;
  for (const Rollout& rollout : read_recording(kReal, std::nullopt).rollouts) {
    double worst = 0.0;
    for (Index t = 0; t < rollout.num_steps(); ++t) {
      const auto head = [t](const RowMatrix& values) -> Eigen::Vector3d {
        return sim::head_pose(joints(values, t)).translation();
      };
      worst = std::max(worst, (head(rollout.states) - head(rollout.actions)).norm());
    }
    EXPECT_LT(worst, 1e-4) << rollout.name;
  }
}

// The twin of the recordings.
TEST(MinigolfRecording, OfASimulationIsOne) {
  const TempFolder folder;
  const auto simulator = sim::make_simulator({.name = "minigolf"});
  const Target target = simulator->behave(sim::complete_theta(*simulator, {}), 3, 1);
  write_recording(target, folder / "twin.h5");
  const Target recorded = read_recording(folder / "twin.h5", golf_channels());
  EXPECT_EQ(content_hash(recorded), content_hash(target));
  expect_strikes(recorded);
}

}  // namespace
}  // namespace npdr::pipeline
