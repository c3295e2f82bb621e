/// The club's head: a rectangle of 17 x 70 mm swept by a sphere of 5 mm.
#pragma once

namespace npdr::sim {

inline constexpr double kHeadHalfX = 0.0085;  ///< [m] of the rectangle, in the head's frame
inline constexpr double kHeadHalfY = 0.035;   ///< [m]
inline constexpr double kHeadRadius = 0.005;  ///< [m] of the sphere
inline constexpr double kHeadBoundingRadius = 0.0411;  ///< [m] about the head's center

}  // namespace npdr::sim
