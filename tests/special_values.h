/// What arithmetic makes of overflows and of nothing, for tests that feed it in.
#pragma once

#include <limits>

namespace npdr {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();

}  // namespace npdr
