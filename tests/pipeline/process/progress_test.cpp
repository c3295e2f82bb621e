#include "pipeline/process/progress.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

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
