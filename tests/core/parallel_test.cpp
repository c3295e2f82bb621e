#include "core/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace npdr {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnce) {
  std::vector<int> visits(1000, 0);
  parallel_for(1000, [&](Index i) { ++visits[static_cast<std::size_t>(i)]; });
  EXPECT_EQ(visits, std::vector<int>(1000, 1));
}

TEST(ParallelFor, RethrowsWhatABodyThrew) {
  EXPECT_THROW(parallel_for(100,
                            [](Index i) {
                              if (i == 42) throw std::runtime_error("row 42");
                            }),
               std::runtime_error);
}

}  // namespace
}  // namespace npdr
