#include "analysis/process.h"

#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/temp_folder.h"

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

TEST(Process, TellsAMissingProgramFromAMissingFolder) {
  const TempFolder folder;
  EXPECT_FALSE(run_process("npdr-no-such-program", {}, folder.path()).found);
  EXPECT_THROW(run_process("true", {}, folder.path() / "missing"), Error);
}

}  // namespace
}  // namespace npdr::analysis
