/// Angles in radians.
#pragma once

#include <numbers>

namespace npdr::sim {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180.0;

}  // namespace npdr::sim
