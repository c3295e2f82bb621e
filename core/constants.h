/// Numbers that aren't on the real line, and those that several folders use.
#pragma once

#include <limits>

namespace npdr {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// No value: of what failed, isn't known or doesn't exist.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr float kFloatNaN = std::numeric_limits<float>::quiet_NaN();

inline constexpr double kLogTwoPi = 1.8378770664093453;  ///< log(2 pi)
/// Relative difference of values that are the same but for the rounding of single precision: eight
/// times its smallest step, 2^-23.
inline constexpr double kFloatRounding = 1e-6;

}  // namespace npdr
