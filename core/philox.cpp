#include "core/philox.h"

#include <Random123/philox.h>

namespace npdr {
namespace {

// One word of all counters: a vector register of an AVX-512 machine.
using Lanes = std::array<std::uint32_t, kPhiloxCounters>;

std::uint64_t count_of(const std::array<std::uint32_t, 4>& counter) {
  return (std::uint64_t{counter[1]} << 32) | counter[0];
}

}  // namespace

void philox(const std::array<std::uint32_t, 4>& counter, std::array<std::uint32_t, 2> key,
            std::span<std::uint32_t, kPhiloxWords> words) {
  Lanes a, b, c, d;
  for (std::size_t i = 0; i < kPhiloxCounters; ++i) {
    const std::uint64_t count = count_of(counter) + i;
    a[i] = low_word(count);
    b[i] = high_word(count);
    c[i] = counter[2];
    d[i] = counter[3];
  }
  for (unsigned round = 0; round < philox4x32_rounds; ++round) {
#pragma omp simd
    for (std::size_t i = 0; i < kPhiloxCounters; ++i) {
      const std::uint64_t even = std::uint64_t{PHILOX_M4x32_0} * a[i];
      const std::uint64_t odd = std::uint64_t{PHILOX_M4x32_1} * c[i];
      a[i] = high_word(odd) ^ b[i] ^ key[0];
      b[i] = low_word(odd);
      c[i] = high_word(even) ^ d[i] ^ key[1];
      d[i] = low_word(even);
    }
    key[0] += PHILOX_W32_0;
    key[1] += PHILOX_W32_1;
  }
  for (std::size_t i = 0; i < kPhiloxCounters; ++i) {
    words[4 * i] = a[i];
    words[4 * i + 1] = b[i];
    words[4 * i + 2] = c[i];
    words[4 * i + 3] = d[i];
  }
}

void advance_philox(std::array<std::uint32_t, 4>& counter) {
  const std::uint64_t count = count_of(counter) + kPhiloxCounters;
  counter[0] = low_word(count);
  counter[1] = high_word(count);
}

}  // namespace npdr
