#include "tests/cli/program.h"
#include "tests/pipeline/small_study.h"

namespace npdr::pipeline {
namespace {

class BadInput : public SmallStudyTest {
 protected:
  // The outcome of a run of the small study with `from` replaced by `to`.
  Outcome run_with(const std::string& from, const std::string& to) {
    std::ofstream(folder_.path() / "small.toml") << edited(small_study(), from, to);
    return npdr({"run", "small.toml"});
  }

  static void expect_rejected(const Outcome& outcome, const std::string& part) {
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(has(outcome.err, part));
  }
};

// The pendulum's behavior isn't random: its held-out rollout would be one that inference has seen.
TEST_F(BadInput, HeldOutRolloutsThatAreNone) {
  expect_rejected(run_with("num_rollouts = 2", "num_rollouts = 2\nheld_out = 1"),
                  "target.held_out: rollout 'simulated 2' is the same as 'simulated 0'");
}

TEST_F(BadInput, FoldsThatHaveBeenSeen) {
  expect_rejected(npdr({"run", "small.toml", "--set", "target.num_rollouts=3", "--set",
                        "evaluate.leave_out=3", "--until", "held_out"}),
                  "evaluate.leave_out: rollout 'simulated 0' is the same as 'simulated 1'");
}

TEST_F(BadInput, TooManyFailedRolloutsHaveAStatusOfTheirOwn) {
  // A torque of 4.5 N m on a rod of 1 cm and some grams: the integration diverges.
  const Outcome outcome =
      run_with("pole_mass = { uniform = [0.3, 1.7] }\npole_length = { uniform = [0.3, 1.7] }",
               "pole_mass = { uniform = [0.01, 0.02] }\npole_length = { uniform = [0.01, 0.02] }");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_TRUE(has(outcome.err, "rows failed ("));
  npdr(0, {"inspect", "runs/small/npdr-maf/seed-1/round-1/simulate.h5"});
  for (const char* command : {"status", "explain"}) {
    const Outcome shown = npdr({command, "small.toml"});
    EXPECT_TRUE(has(shown.out, {"failed", "rows failed ("}));
  }
}

TEST_F(BadInput, RoundThatNoMethodHas) {
  for (const char* round : {"0", "3"}) {
    for (const char* program : {"npdr-propose", "npdr-infer", "npdr-report"}) {
      expect_rejected(run(folder_.path(), {program, "small.toml", "--round", round}),
                      "--round " + std::string(round) + ": the methods have rounds 1 to 2\n");
    }
  }
}

TEST_F(BadInput, StudiesThatArentThereAndSeedsAndMethodsThatAStudyDoesNotHave) {
  npdr(2, {"run", "none.toml"});
  expect_rejected(run(folder_.path(), {"npdr-infer", "small.toml", "--seeds", "7"}), "seed 7");
  expect_rejected(run(folder_.path(), {"npdr-infer", "small.toml", "--only", "NPDR (MAV)"}),
                  "NPDR (MAV)");
}

TEST_F(BadInput, OutputThatCannotBeWrittenIsAnError) {
  const Outcome made = run(folder_.path(), {"npdr", "run", "small.toml"}, {.err = "/dev/full"});
  EXPECT_EQ(made.status, 0) << "progress that can't be written is none";
  const Streams full{.out = "/dev/full"};
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"npdr", "status", "small.toml"},
        {"npdr", "validate", "small.toml"},
        {"npdr", "list", "simulators"},
        {"npdr", "run", "small.toml"},
        {"npdr", "sample", "runs/small/npdr-maf/seed-1/round-2/infer.h5", "-n", "5"},
        {"npdr", "--help"},
        {"npdr-infer", "small.toml"},
        {"npdr-infer", "--version"}}) {
    const Outcome outcome = run(folder_.path(), words, full);
    EXPECT_EQ(outcome.status, 1) << words[0] << " " << words[1];
    EXPECT_TRUE(has(outcome.err, "No space left on device"));
  }
}

}  // namespace
}  // namespace npdr::pipeline
