// Texts that fit a terminal.
#include <gtest/gtest.h>

#include "pipeline/process/fitted_text.h"
#include "pipeline/process/live_lines.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

TEST(FittedText, EndsInDotsWhereItIsLonger) {
  EXPECT_EQ(fitted("simulate", 8), "simulate");
  EXPECT_EQ(fitted("simulate NPE", 11), "simulate...");
  EXPECT_EQ(fitted("simulate", 2), "..");
  EXPECT_EQ(fitted("aé±…", 4), "aé±…") << "characters count, not bytes";
  EXPECT_EQ(fitted("振り子の", 8), "振り子の");
  EXPECT_EQ(fitted("振り子の", 7), "振り...");
  EXPECT_EQ(fitted("振り子の", 6), "振...");
}

TEST(WrappedText, BreaksBetweenWords) {
  EXPECT_EQ(wrapped("NPE: all 7 checks pass", 22), "NPE: all 7 checks pass");
  EXPECT_EQ(wrapped("NPE: all 7 checks pass", 21), "NPE: all 7 checks\npass");
  EXPECT_EQ(wrapped("a  b", 9), "a b");
  EXPECT_EQ(wrapped("", 9), "");
}

TEST(WrappedText, KeepsTheIndentAndWordsThatAreTooLong) {
  EXPECT_EQ(wrapped("  one two three", 7), "  one\n  two\n  three");
  EXPECT_EQ(wrapped("a verylongword b", 5), "a\nverylongword\nb");
}

TEST(WrappedText, CountsCharactersAndNotBytes) {
  EXPECT_EQ(wrapped("1 ± 2", 5), "1 ± 2");
  EXPECT_EQ(wrapped("日本 a", 6), "日本 a");
  EXPECT_EQ(wrapped("日本 a", 5), "日本\na");
}

const std::string kText =
    "Fit.\n\n"
    "| Metric | NPE \\| a |     prior |\n"
    "|:-------|---------:|----------:|\n"
    "| RMSE   |  1 ± 0.1 | 5.8 ± 1.1 |\n"
    "\nMade by:\n";

TEST(FittedTables, LeaveOutTheColumnsThatATerminalHasNoRoomFor) {
  EXPECT_EQ(fitted_tables(kText, 33, "t.md"), kText);
  const std::string cut =
      "Fit.\n\n"
      "| Metric | NPE \\| a |\n"
      "|:-------|---------:|\n"
      "| RMSE   |  1 ± 0.1 |\n"
      "(1 more column in t.md)\n"
      "\nMade by:\n";
  EXPECT_EQ(fitted_tables(kText, 32, "t.md"), cut);
  EXPECT_EQ(fitted_tables(kText, 21, "t.md"), cut);
}

TEST(FittedTables, KeepTheFirstColumn) {
  const std::string text = fitted_tables(kText, 5, "t.md");
  EXPECT_NE(text.find("\n| Metric |\n"), std::string::npos) << text;
  EXPECT_NE(text.find("(2 more columns in t.md)"), std::string::npos) << text;
}

TEST(FittedTables, WrapProseButNotWhatPeopleCopy) {
  const std::string text = "Fit of samples to\n\n    npdr run a_long_name.toml\n";
  EXPECT_EQ(fitted_tables(text, 10, "t.md"),
            "Fit of\nsamples to\n\n    npdr run a_long_name.toml\n");
}

TEST(LiveLines, ABarIsAsFullAsTheWorkIsDone) {
  EXPECT_EQ(bar(0.0, 12), "[..........]");
  EXPECT_EQ(bar(0.55, 12), "[#####.....]");
  EXPECT_EQ(bar(1.0, 12), "[##########]");
  EXPECT_EQ(bar(7.0, 4), "[##]");
}

TEST(Progress, TextHoldsCountsTimeAndRate) {
  EXPECT_EQ(progress_text(400, 1000, 4.0), "400/1000 [00:04<00:06, 100/s]");
  EXPECT_EQ(progress_text(900, 1000, 4.0, 500), "900/1000 [00:04<00:01, 100/s]");
  EXPECT_EQ(progress_text(0, 1000, 0.0), "0/1000 [00:00<?, 0/s]");
  EXPECT_EQ(progress_text(30, 0, 60.0), "30 [01:00, 0.5/s]");
}

TEST(Progress, ClockShowsHoursOnlyWhenThereAreSome) {
  EXPECT_EQ(clock_text(205.9), "03:25");
  EXPECT_EQ(clock_text(3723.0), "1:02:03");
}

}  // namespace
}  // namespace npdr::pipeline
