#include "pipeline/predictions/search_box.h"

#include <gtest/gtest.h>

#include <cmath>

namespace npdr::pipeline {
namespace {

using inference::Marginal;

TEST(SearchBox, IsThePriorInsideOfWhatIsPossible) {
  const auto simulator = sim::make_simulator({.name = "pendulum"});
  const SearchBox box = search_box({{"pole_mass", "kg", Marginal::Kind::uniform, 0.3, 1.7},
                                    {"pole_length", "m", Marginal::Kind::log_uniform, 0.1, 2.0},
                                    {"gravity", "m/s^2", Marginal::Kind::normal, 9.0, 0.5},
                                    {"damping", "N m s/rad", Marginal::Kind::normal, 0.33, 0.1}},
                                   simulator->info());
  EXPECT_EQ(box.lower, (Vector{{0.3, 0.1, 7.0, 0.0}})) << "no negative damping";
  EXPECT_EQ(box.upper, (Vector{{1.7, 2.0, 11.0, 0.33 + 4.0 * 0.1}}));
  const SearchBox log_normal =
      search_box({{"pole_mass", "kg", Marginal::Kind::log_normal, 0.0, 0.25}}, simulator->info());
  EXPECT_DOUBLE_EQ(log_normal.lower(0), std::exp(-1.0));
  EXPECT_DOUBLE_EQ(log_normal.upper(0), std::exp(1.0));
}

}  // namespace
}  // namespace npdr::pipeline
