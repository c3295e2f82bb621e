#include "sim/minigolf/rolling.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace npdr::sim {
namespace {

constexpr double kSmall = 1e-4;  // of b t, from which on differences would cancel

// Integrals of exp(-b t): phi1 once, phi2 twice, from 0 to t.
double phi1(double b, double t) {
  const double z = b * t;
  return z < kSmall ? t * (1.0 - z / 2.0 + z * z / 6.0) : -std::expm1(-z) / b;
}

double phi2(double b, double t) {
  const double z = b * t;
  return z < kSmall ? t * t * (0.5 - z / 6.0 + z * z / 24.0) : (t - phi1(b, t)) / b;
}

}  // namespace

double RollingLaw::time_to_rest(double speed) const {
  if (a_ == 0.0) return kInfinity;
  const double ratio = b_ * speed / a_;
  return ratio < kSmall ? speed / a_ * (1.0 - ratio / 2.0 + ratio * ratio / 3.0)
                        : std::log1p(ratio) / b_;
}

Rolled RollingLaw::roll(double speed, double duration) const {
  const double rest = time_to_rest(speed);
  const double t = std::min(duration, rest);
  const double distance = speed * phi1(b_, t) - a_ * phi2(b_, t);
  if (rest <= duration) return {distance, 0.0};
  return {distance, std::max(0.0, speed - (a_ + b_ * speed) * phi1(b_, t))};
}

}  // namespace npdr::sim
