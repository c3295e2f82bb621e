/// Values of floating-point numbers that aren't on the real line.
#pragma once

#include <limits>

namespace npdr {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// No value: of what failed, isn't known or doesn't exist.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr float kFloatNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace npdr
