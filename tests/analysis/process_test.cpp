#include "analysis/process.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/temp_folder.h"
#include "tests/wait_for.h"

namespace npdr::analysis {
namespace {

TEST(Process, ReportsExitStatusAndStandardError) {
  const TempFolder folder;
  const auto result =
      run_process("sh", {"-c", "echo dropped; echo kept >&2; exit 3"}, folder.path());
  EXPECT_TRUE(result.found);
  EXPECT_EQ(result.exit_status, 3);
  EXPECT_EQ(result.errors, "kept\n");
  EXPECT_EQ(run_process("true", {}, folder.path()).exit_status, 0);
}

TEST(Process, ReportsTheSignalThatEndedIt) {
  const TempFolder folder;
  EXPECT_EQ(run_process("sh", {"-c", "kill -9 $$"}, folder.path()).exit_status, 128 + 9);
}

TEST(Process, RunsInItsFolderWithItsArgumentsUntouched) {
  const TempFolder folder;
  const std::string nasty = "a b; $(touch broken) `touch broken` 'q' \"d\" *\n";
  run_process("sh", {"-c", "printf %s \"$1\" > out", "sh", nasty}, folder.path());
  EXPECT_EQ(read_text_file(folder.path() / "out"), nasty);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "broken"));
}

TEST(Process, TakesMoreErrorsThanAPipeHolds) {
  const TempFolder folder;
  const auto result =
      run_process("sh", {"-c", "head -c 300000 /dev/zero | tr '\\0' x >&2"}, folder.path());
  EXPECT_EQ(result.errors.size(), 300'000u);
}

TEST(Process, EndsWithAllThatItHasStartedAtItsTimeLimit) {
  const TempFolder folder;
  const ProcessOptions brief = {.time_limit = 0.3};
  for (const std::string command :
       {"sleep 1000 & echo $! > child; wait", "exec 2> /dev/null; echo $$ > child; sleep 1000"}) {
    const auto result = run_process("sh", {"-c", command}, folder.path(), brief);
    EXPECT_TRUE(result.timed_out);
    EXPECT_EQ(result.exit_status, 128 + SIGKILL);
    const pid_t child = std::stoi(read_text_file(folder.path() / "child"));
    EXPECT_TRUE(comes_true([&] { return has_ended(child); }));
  }
  EXPECT_FALSE(run_process("true", {}, folder.path()).timed_out);
}

TEST(Process, EndsWithWhoStartedIt) {
  const TempFolder folder;
  const pid_t starter = fork();
  if (starter == 0) {
    run_process("sh", {"-c", "echo $$ > program; exec sleep 1000"}, folder.path());
    _exit(0);
  }
  EXPECT_TRUE(comes_true([&] { return text_of(folder / "program").ends_with('\n'); }));
  kill(starter, SIGKILL);
  waitpid(starter, nullptr, 0);
  const pid_t program = std::stoi(text_of(folder / "program"));
  EXPECT_TRUE(comes_true([&] { return has_ended(program); }));
}

TEST(Process, DoesNotGetVariablesThatAreLeftOut) {
  const TempFolder folder;
  setenv("NPDR_TEST_LEFT_OUT", "here", 1);
  const std::vector<std::string> words = {"-c", "echo \"$NPDR_TEST_LEFT_OUT\" >&2"};
  EXPECT_EQ(run_process("sh", words, folder.path()).errors, "here\n");
  EXPECT_EQ(run_process("sh", words, folder.path(), {.unset = {"NPDR_TEST_LEFT_OUT"}}).errors,
            "\n");
}

TEST(Process, TellsAMissingProgramFromAMissingFolder) {
  const TempFolder folder;
  EXPECT_FALSE(run_process("npdr-no-such-program", {}, folder.path()).found);
  EXPECT_THROW(run_process("true", {}, folder.path() / "missing"), Error);
}

}  // namespace
}  // namespace npdr::analysis
