#include "pipeline/apps/command_line.h"
#include "core/shell_text.h"

#include <gtest/gtest.h>

#include <limits>

#include "pipeline/sources/command_text.h"

namespace npdr::pipeline {
namespace {

TEST(CommandLine, RangesAreExpanded) {
  EXPECT_EQ(parse_ranges("0-3,7"), (std::vector<Index>{0, 1, 2, 3, 7}));
  EXPECT_EQ(parse_ranges("5"), (std::vector<Index>{5}));
  constexpr Index largest = std::numeric_limits<Index>::max();
  EXPECT_EQ(parse_ranges("9223372036854775807"), (std::vector<Index>{largest}));
}

TEST(CommandLine, BadRangesAreRejected) {
  for (const char* text : {"", "a", "3-1", "-1", "1-", "1,,2", "1;2", "0-99999999999"}) {
    EXPECT_THROW(parse_ranges(text), InputError) << text;
  }
}

TEST(CommandLine, WordsNameTheSameStudyAgain) {
  StudyArguments arguments;
  arguments.file = "a.toml";
  arguments.overrides = {"x=1"};
  arguments.work = "elsewhere";
  arguments.methods = {"NPDR (MAF)"};
  arguments.seeds = {1, 2};
  EXPECT_EQ(shell_text(arguments.words()),
            "a.toml --set x=1 --work elsewhere --only 'NPDR (MAF)' --seeds 1,2");
}

TEST(CommandLine, EveryErrorHasItsExitStatus) {
  const auto status_of = [](auto error) {
    return guarded_main("test", [&]() -> ExitStatus { throw error; });
  };
  EXPECT_EQ(status_of(InputError("x")), 2);
  EXPECT_EQ(status_of(Error("x")), 1);
  EXPECT_EQ(status_of(FailedRolloutsError("x")), 3);
  EXPECT_EQ(status_of(Checkpointed("x")), 75);
  EXPECT_EQ(status_of(std::runtime_error("x")), 1);
  EXPECT_EQ(guarded_main("test", [] { return ExitStatus::done; }), 0);
}

}  // namespace
}  // namespace npdr::pipeline
