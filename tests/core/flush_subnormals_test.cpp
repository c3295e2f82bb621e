#include "core/flush_subnormals.h"

#include <gtest/gtest.h>

#include <limits>

namespace npdr {
namespace {

// Not known to the compiler, so that the processor multiplies.
float product(float a, float b) {
  volatile float x = a, y = b;
  return x * y;
}

TEST(FlushSubnormals, TakesThemForZeroWhileItLives) {
  constexpr float kSmallest = std::numeric_limits<float>::min();
  ASSERT_GT(product(kSmallest, 0.5f), 0.0f);
#if defined(__SSE2__)
  {
    const FlushSubnormals flush;
    EXPECT_EQ(product(kSmallest, 0.5f), 0.0f) << "a result";
    EXPECT_EQ(product(kSmallest / 4.0f, 8.0f), 0.0f) << "an operand";
    EXPECT_EQ(product(kSmallest, 2.0f), 2.0f * kSmallest);
  }
#endif
  EXPECT_GT(product(kSmallest, 0.5f), 0.0f);
}

}  // namespace
}  // namespace npdr
