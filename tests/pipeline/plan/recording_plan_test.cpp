// Plans of studies on recordings.
#include <gtest/gtest.h>

#include "core/error.h"
#include "pipeline/config/rollout_check.h"
#include "tests/pipeline/plan/plan_parts.h"
#include "tests/pipeline/standing_recording.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// Messages are in tests/golden/config.txt.
class RecordingPlan : public FolderTest {
 protected:
  RecordingPlan() { write_standing(folder_ / "r.h5"); }

  Plan plan(std::vector<std::string> overrides) const {
    overrides.push_back("target.recording=" + (folder_ / "r.h5").string());
    return plan_of(overrides);
  }
};

TEST_F(RecordingPlan, AFloorIsSearchedForRecordingsOnly) {
  const std::string without = "evaluate.floor=false";
  EXPECT_EQ(keys(plan_of({without}), Stage::baseline), keys(plan_of(), Stage::baseline));
  EXPECT_NE(keys(plan({without}), Stage::baseline), keys(plan({}), Stage::baseline));
}

TEST_F(RecordingPlan, AStudyPicksRolloutsOfItsRecording) {
  EXPECT_EQ(names_of(plan({"target.rollouts=[2, 1]"}).target), "secondfirst");
}

TEST_F(RecordingPlan, AChannelThatIsZeroThroughoutIsNamed) {
  Plan still = plan({});
  EXPECT_NO_THROW(require_motion(still.study, still.target));
  RowMatrix& states = still.target.rollouts[1].states;
  states.col(1).head(40).setZero();  // but for the last, which isn't replayed
  EXPECT_TRUE(says(problem([&] { require_motion(still.study, still.target); }),
                   {"--set target.recording=", "channel 'theta_dot' of rollout 'second' is 0",
                    "leave out the rollout (target.rollouts)"}));
  states.col(1).setZero();
  states(0, 1) = 1.0;  // the first one, of which there is no noise
  EXPECT_THROW(require_motion(still.study, still.target), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
