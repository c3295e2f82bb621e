#include "pipeline/features/series_summary.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

// One rollout of two states of two picked channels out of three.
inference::SeriesSelection selection() { return {1, 2, 3, 1, {0, 2}}; }

TEST(SeriesSummary, HoldsFiveNumbersOfEachChannel) {
  const std::vector<float> picked = {1.0f, -4.0f, 3.0f, -6.0f};
  EXPECT_EQ(summarize(picked, selection()),
            (Vector{{2.0, 1.0, 1.0, 3.0, 3.0, -5.0, 1.0, -6.0, -4.0, -6.0}}));
}

TEST(SeriesSummary, NamesThePickedChannels) {
  const auto names = summary_names(selection(), {{"x", "m"}, {"y", "m"}, {"z", "m"}});
  ASSERT_EQ(names.size(), 10u);
  EXPECT_EQ(names.front(), "rollout 1, x: mean");
  EXPECT_EQ(names.back(), "rollout 1, z: last");
}

}  // namespace
}  // namespace npdr::pipeline
