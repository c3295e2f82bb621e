// Tables that fit a terminal; other texts are in tests/golden/text.txt.

#include "pipeline/process/fitted_text.h"

#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

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

TEST(FittedTables, KeepTheFirstColumnAndWhatPeopleCopy) {
  EXPECT_TRUE(has(fitted_tables(kText, 5, "t.md"), {"\n| Metric |\n", "(2 more columns in t.md)"}));
  const std::string text = "Fit of samples to\n\n    npdr run a_long_name.toml\n";
  EXPECT_EQ(fitted_tables(text, 10, "t.md"),
            "Fit of\nsamples to\n\n    npdr run a_long_name.toml\n");
}

}  // namespace
}  // namespace npdr::pipeline
