#include "pipeline/process/shell_text.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

TEST(ShellText, QuotesSurviveAShell) {
  EXPECT_EQ(shell_word("plain-1.csv"), "plain-1.csv");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace npdr::pipeline
