#include "core/philox.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <limits>

namespace npdr {
namespace {

using Counter = std::array<std::uint32_t, 4>;

TEST(Philox, HasTheWordsOfRandom123) {
  constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  const std::array<std::uint32_t, 2> key = {0x12345678u, 0x9abcdef0u};
  for (const Counter& first : {Counter{0, 0, 0, 0}, Counter{most - 7, 3, 5, 1u << 31},
                               Counter{most - 15, 0, most, 7}, Counter{most - 2, most, 1, 2}}) {
    std::array<std::uint32_t, kPhiloxWords> words;
    philox(first, key, words);
    Counter counter = first;
    for (std::size_t i = 0; i < kPhiloxCounters; ++i) {
      const auto expected = r123::Philox4x32{}({{counter[0], counter[1], counter[2], counter[3]}},
                                               {{key[0], key[1]}});
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), words.begin() + 4 * i)) << i;
      if (++counter[0] == 0) ++counter[1];
    }
    Counter advanced = first;
    advance_philox(advanced);
    EXPECT_EQ(advanced, counter);
  }
}

}  // namespace
}  // namespace npdr
