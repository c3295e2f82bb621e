/// Motions as labs record them, for tests of what checks recordings.
#pragma once

#include <cmath>
#include <string_view>

#include "core/random.h"
#include "core/types.h"

namespace npdr::pipeline {

/// Positions [rad] and rates [rad/s], dt [s] apart.
struct Motion {
  Vector position, rate;
  double dt;
};

/// A sum of three swings of 0.3 to 3 Hz, of up to half a radian each; each `row` is another.
inline Motion smooth_motion(Index count, double dt, std::uint64_t row) {
  Motion motion{Vector::Zero(count), Vector::Zero(count), dt};
  Stream stream({1, "motion", 0, row, 0});
  for (int k = 0; k < 3; ++k) {
    const double omega = 2.0 * M_PI * 0.3 * std::pow(10.0, stream.uniform());
    const double phase = 2.0 * M_PI * stream.uniform(), size = 0.1 + 0.4 * stream.uniform();
    for (Index t = 0; t < count; ++t) {
      const double angle = omega * dt * static_cast<double>(t) + phase;
      motion.position(t) += size * std::sin(angle);
      motion.rate(t) += size * omega * std::cos(angle);
    }
  }
  return motion;
}

inline Vector rounded(const Vector& values, double step) {
  return (values / step).array().round() * step;
}

inline Vector with_noise(const Vector& values, double deviation, std::uint64_t row) {
  Stream stream({1, "noise", 0, row, 0});
  return values.unaryExpr([&](double value) { return value + deviation * stream.normal(); });
}

/// Values after a filter of first order with this time constant [s].
inline Vector lagging(const Vector& values, double time, double dt) {
  Vector result = values;
  for (Index t = 1; t < values.size(); ++t) {
    result(t) = result(t - 1) + dt / (time + dt) * (values(t) - result(t - 1));
  }
  return result;
}

/// Differences of the positions to the sample before.
inline Vector backward_differences(const Vector& position, double dt) {
  Vector rate = Vector::Zero(position.size());
  rate.tail(rate.size() - 1) =
      (position.tail(rate.size() - 1) - position.head(rate.size() - 1)) / dt;
  return rate;
}

/// Recordings of one motion by usual devices, all of them right: encoders with 2048 counts a turn,
/// rates by differences, through a filter of 20 ms, or by a gyroscope.
inline std::vector<Motion> recorded(const Motion& motion, std::uint64_t row) {
  const Vector counts = rounded(motion.position, 2.0 * M_PI / 2048.0);
  const Vector differences = backward_differences(counts, motion.dt);
  return {{counts, motion.rate, motion.dt},
          {counts, differences, motion.dt},
          {counts, lagging(differences, 0.02, motion.dt), motion.dt},
          {counts, with_noise(motion.rate, 0.2, row), motion.dt},
          {with_noise(motion.position, 2e-3, row), with_noise(motion.rate, 0.3, row + 1000),
           motion.dt}};
}

}  // namespace npdr::pipeline
