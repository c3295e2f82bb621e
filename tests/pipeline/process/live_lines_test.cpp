#include "pipeline/process/live_lines.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

TEST(LiveLines, NoneIsWiderThanTheTerminal) {
  EXPECT_EQ(fitted("simulate", 8), "simulate");
  EXPECT_EQ(fitted("simulate NPE", 11), "simulate...");
  EXPECT_EQ(fitted("simulate", 2), "..");
  EXPECT_EQ(fitted("aé±…", 4), "aé±…") << "characters count, not bytes";
  EXPECT_EQ(fitted("振り子の", 8), "振り子の");
  EXPECT_EQ(fitted("振り子の", 7), "振り...");
  EXPECT_EQ(fitted("振り子の", 6), "振...");
}

TEST(LiveLines, ABarIsAsFullAsTheWorkIsDone) {
  EXPECT_EQ(bar(0.0, 12), "[..........]");
  EXPECT_EQ(bar(0.55, 12), "[#####.....]");
  EXPECT_EQ(bar(1.0, 12), "[##########]");
  EXPECT_EQ(bar(7.0, 4), "[##]");
}

}  // namespace
}  // namespace npdr::pipeline
