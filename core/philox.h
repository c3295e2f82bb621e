/// Words of the generator Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as
/// 1, 2, 3") for many counters at once: Random123, whose words they are, takes one counter at a
/// time.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace npdr {

/// The lower and the upper half of `v`.
constexpr std::uint32_t low_word(std::uint64_t v) { return static_cast<std::uint32_t>(v); }
constexpr std::uint32_t high_word(std::uint64_t v) { return static_cast<std::uint32_t>(v >> 32); }

/// Counters that philox() takes at once, each with four words.
inline constexpr std::size_t kPhiloxCounters = 16;
inline constexpr std::size_t kPhiloxWords = 4 * kPhiloxCounters;

/// The words of `counter` and of the 15 after it, one after the other. The first two words of a
/// counter count, the first of them faster.
void philox(const std::array<std::uint32_t, 4>& counter, std::array<std::uint32_t, 2> key,
            std::span<std::uint32_t, kPhiloxWords> words);

/// Counts on by kPhiloxCounters.
void advance_philox(std::array<std::uint32_t, 4>& counter);

}  // namespace npdr
