#include "pipeline/cluster/task_log.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(TaskLog, SaysWhyATaskEnded) {
  const TempFolder folder;
  const auto log = folder / "a.log";
  std::ofstream(log) << begin_line("17_3", {"npdr-simulate", "a b.toml"}) << "\n"
                     << "npdr-simulate: a.toml: can't be opened\n"
                     << end_line(2, 0.04) << "\n";
  ASSERT_TRUE(end_in_log(log));
  EXPECT_EQ(end_in_log(log)->exit_status, 2);
  EXPECT_EQ(end_in_log(log)->words,
            "exit status 2 after 0.0 s: npdr-simulate: a.toml: can't be opened");
}

TEST(TaskLog, OfARunQuotesWhatTheStageSaid) {
  const TempFolder folder;
  const auto log = folder / "a.log";
  std::ofstream(log) << begin_line("17", {"npdr", "run"}) << "\n"
                     << "npdr: infer NPE, seed 1, round 1 failed (exit status 1):\n"
                     << "    npdr-infer: the disk is full\n    log: runs/a.log\n"
                     << end_line(1, 2.0) << "\n";
  EXPECT_EQ(end_in_log(log).value_or(TaskEnd()).words,
            "exit status 1 after 2.0 s: npdr-infer: the disk is full");
}

TEST(TaskLog, OfATaskThatWasKilledSaysNothing) {
  const TempFolder folder;
  const auto log = folder / "a.log";
  EXPECT_FALSE(end_in_log(log));
  std::ofstream(log) << begin_line("17_3", {"npdr-simulate"}) << "\n";
  EXPECT_FALSE(end_in_log(log));
  std::ofstream(log, std::ios::app) << end_line(75, 3.0) << "\n"
                                    << begin_line("17_3", {"npdr-simulate"}) << "\nhalf a li";
  EXPECT_FALSE(end_in_log(log));
}

}  // namespace
}  // namespace npdr::pipeline
