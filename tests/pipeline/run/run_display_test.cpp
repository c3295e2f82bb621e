#include "pipeline/run/run_display.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

const RunProgress kRun = {"pendulum", 163, 263, 60.0, 0.75, {"infer A: 12 epochs", "evaluate B"}};

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

TEST(RunDisplay, SaysNothingOfTheRestBeforeAnythingIsKnown) {
  RunProgress run = kRun;
  run.share = 0.0;
  EXPECT_EQ(time_text(run), "01:00");
  EXPECT_EQ(log_line(run),
            "pendulum: 0 %, 163 of 263 artefacts [01:00] | infer A: 12 epochs | evaluate B");
}

}  // namespace
}  // namespace npdr::pipeline
