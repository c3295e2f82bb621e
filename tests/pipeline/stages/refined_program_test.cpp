/// Refinements whose simulator is a program of the user's: rows at once, rows that fail.
#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "pipeline/plan/plan.h"
#include "pipeline/run/run_stage.h"
#include "tests/message_of.h"
#include "tests/pipeline/small_study.h"
#include "tests/pipeline/stages/run_until.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// x = a, and no number where a > 0.97, or 0.5 once there is a file `bad`; a line with the number of
// its rows for each call.
constexpr const char* kSimulator = R"sh(
most=0.97; test ! -e bad || most=0.5
awk -F, -v most=$most 'NR > 1 { if ($1 > most) print "nan"; else print $1 } END { print NR - 1 >> "calls" }' "$1" > "$2"
)sh";

class RefinedPrograms : public FolderTest {
 protected:
  RefinedPrograms() {
    folder_.file("x_o.csv", "x\n0.96\n");
    folder_.file("simulate.sh", kSimulator);
  }

  Plan plan_of(const std::string& max_failed_fraction) const {
    const std::string text = command_study("program")
                                 .only("prior", {"a = { uniform = [0.0, 1.0] }"})
                                 .with("observation_noise", {"std = { x = 0.1 }"})
                                 .with("simulate", {"shard_size = 100"})
                                 .with("limits", {"max_failed_fraction = " + max_failed_fraction})
                                 .method("Prior", {"algorithm = \"refine\"",
                                                   "refine = { level_size = 1000, min_ess = 300 }"})
                                 .with("evaluate", {"num_samples = 20"});
    return make_plan(parse_study(text, folder_ / "s.toml"), WorkFolder(folder_ / "work"));
  }
};

// They begin after the simulations of the prior, which were fine.
TEST_F(RefinedPrograms, StopAtTooManyFailures) {
  const Plan plan = plan_of("0.05");
  const std::string message = message_of<FailedRolloutsError>(
      [&] {
        for (const Node& node : plan.nodes) {
          if (node.stage == Stage::infer) folder_.file("bad", "");
          run_stage(plan, node);
        }
      },
      &folder_);
  EXPECT_TRUE(has(message, "a refinement takes their parameters for impossible"));
}

// Between two calls a checkpoint can be written.
TEST_F(RefinedPrograms, AreCalledWithAShardAtMost) {
  run_until(plan_of("1"), Stage::evaluate);
  std::istringstream calls(text_of(folder_ / "calls"));
  Index most = 0;
  for (Index rows = 0; calls >> rows;) most = std::max(most, rows);
  EXPECT_GT(most, 0);
  EXPECT_LE(most, 100);
}

}  // namespace
}  // namespace npdr::pipeline
