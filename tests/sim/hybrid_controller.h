/// The Furuta's hybrid controller and reward, one state at a time: as the public record of the
/// experiments writes them, with the library's sine, cosine and remainder.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types.h"
#include "sim/furuta.h"

namespace npdr::sim {

/// Policy (E_ref, mu, k_theta, gains (4)), state (theta, alpha, theta_dot, alpha_dot), nominal
/// model. The commanded voltage, not clipped.
inline double hybrid_controller(const Vector& policy, const Vector& x) {
  constexpr double m_p = 0.024, l_p = 0.129, m_r = 0.095, l_r = 0.085, g = 9.81;
  constexpr double r_m = 8.4, k_m = 0.042, pi = std::numbers::pi;
  const double c = std::cos(x(1));
  if (std::abs(1.0 + c) < 1.0 + std::cos(pi - 20.0 * pi / 180.0)) {
    const double alpha = x(1) - 2.0 * pi * std::floor(x(1) / (2.0 * pi));
    return policy(3) * (0.0 - x(0)) + policy(4) * (pi - alpha) + policy(5) * (0.0 - x(2)) +
           policy(6) * (0.0 - x(3));
  }
  const double inertia = m_p * l_p * l_p / 12.0;
  const double energy = 0.5 * inertia * x(3) * x(3) + 0.5 * m_p * g * l_p * (1.0 - c);
  const double product = x(3) * c;
  const double sign = product > 0.0 ? 1.0 : (product < 0.0 ? -1.0 : 0.0);
  const double a = policy(1) * (energy - policy(0)) * sign - policy(2) * x(0);
  return r_m / k_m * m_r * l_r * std::clamp(a, -5.0, 5.0);
}

inline double swing_up_reward(const Vector& x, double commanded) {
  const double pole = std::remainder(std::numbers::pi - x(1), 2.0 * std::numbers::pi);
  return std::exp(-(x(0) * x(0) + pole * pole + 0.02 * x(2) * x(2) + 0.005 * x(3) * x(3) +
                    0.004 * commanded * commanded));
}

}  // namespace npdr::sim
