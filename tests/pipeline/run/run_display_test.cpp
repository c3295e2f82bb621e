#include "pipeline/run/run_progress.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

const RunProgress kRun = {
    "pendulum", 163, 263, 60.0, 0.75, 20.0, {"infer A: 12 epochs", "evaluate B"}};

TEST(RunDisplay, HasABarAndALineForEachJob) {
  EXPECT_EQ(live_lines(kRun, {80, 24}),
            (std::vector<std::string>{
                "pendulum [################......]  75 % 01:00, 00:20 left, 163 of 263 artefacts",
                "  infer A: 12 epochs", "  evaluate B"}));
}

TEST(RunDisplay, NamesOneJobWhereThereIsNoRoom) {
  EXPECT_EQ(live_lines(kRun, {80, 4}).back(), "  2 jobs: infer A: 12 epochs");
  EXPECT_EQ(live_lines(kRun, {80, 2}).size(), 1u);
}

TEST(RunDisplay, SaysForHowLongAJobHasSaidNothing) {
  EXPECT_EQ(silence_text(59.0), "");
  EXPECT_EQ(silence_text(135.0), ", nothing new for 02:15");
}

TEST(RunDisplay, SaysNothingOfTheRestBeforeAnythingIsKnown) {
  RunProgress run = kRun;
  run.share = run.seconds_left = std::nullopt;
  EXPECT_EQ(log_line(run),
            "pendulum: 163 of 263 artefacts [01:00] | infer A: 12 epochs | evaluate B");
  EXPECT_EQ(live_lines(run, {80, 24}).front(),
            "pendulum [......................] 01:00, 163 of 263 artefacts");
}

}  // namespace
}  // namespace npdr::pipeline
