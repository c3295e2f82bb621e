/// When long work writes its state anew.
#pragma once

#include <chrono>

namespace npdr::pipeline {

using Clock = std::chrono::steady_clock;

inline constexpr double kSecondsBetweenCheckpoints = 60.0;

inline double seconds_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

}  // namespace npdr::pipeline
