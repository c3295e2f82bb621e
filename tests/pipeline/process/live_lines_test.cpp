#include "pipeline/process/live_lines.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

TEST(LiveLines, ABarIsAsFullAsTheWorkIsDone) {
  EXPECT_EQ(bar(0.0, 12), "[..........]");
  EXPECT_EQ(bar(0.55, 12), "[#####.....]");
  EXPECT_EQ(bar(1.0, 12), "[##########]");
  EXPECT_EQ(bar(7.0, 4), "[##]");
}

}  // namespace
}  // namespace npdr::pipeline
