#include "pipeline/run/failure_words.h"

#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(FailureWords, TellACauseOnce) {
  FailureWords words;
  EXPECT_EQ(words.tell("simulate", 1, {"sim failed for each of 32 rows: KeyError", "  in a.log"},
                       {"logs/1.log"}),
            "npdr: simulate failed (exit status 1):\n"
            "    sim failed for each of 32 rows: KeyError\n      in a.log\n    log: logs/1.log\n");
  EXPECT_EQ(words.tell("baseline", 1, {"sim failed for each of 65 rows: KeyError", "  in b.log"},
                       {"logs/2.log"}),
            "npdr: baseline failed (exit status 1), as above:\n      in b.log\n"
            "    log: logs/2.log\n");
  EXPECT_EQ(words.tell("infer", 2, {"posterior.h5: is damaged"}, {"logs/3.log"}),
            "npdr: infer failed (exit status 2):\n    posterior.h5: is damaged\n"
            "    log: logs/3.log\n");
  EXPECT_EQ(words.tell("infer", 2, {"posterior_2.h5: is damaged", "  in a.log"}, {"logs/4.log"}),
            "npdr: infer failed (exit status 2):\n    posterior_2.h5: is damaged\n"
            "    log: logs/4.log\n");
}

TEST(FailureWords, OfAJobThatWasStoppedSaySo) {
  EXPECT_EQ(FailureWords().tell("infer", 75, {"stopped on request"}, {"logs/1.log"}),
            "npdr: infer stopped (exit status 75):\n    stopped on request\n    log: logs/1.log\n");
}

TEST(FailureWords, AreTheEndOfTheLogWhereAJobSaysNothing) {
  const TempFolder folder;
  std::string lines;
  for (int i = 1; i <= 21; ++i) lines += std::to_string(i) + "\n";
  const auto log = folder.file("log", lines);
  const std::string told = FailureWords().tell("infer", 137, {}, {log});
  EXPECT_TRUE(
      told.starts_with("npdr: infer failed (killed by signal 9, often for want of memory; "
                       "run it again, with a smaller --jobs if that recurs):\n    2\n    3\n"))
      << told;
  EXPECT_TRUE(told.ends_with("    21\n    log: " + log.string() + "\n")) << told;
  EXPECT_EQ(FailureWords().tell("infer", 139, {}, {log, std::filesystem::file_size(log)}),
            "npdr: infer failed (killed by signal 11, it crashed, maybe in a simulator.library; a "
            "worker that crashes costs only rows):\n    log: " +
                log.string() + "\n")
      << "what an earlier job left there is none of its words";
}

}  // namespace
}  // namespace npdr::pipeline
