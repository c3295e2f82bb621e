/// The unknown parameters of a channel's noise in the space where their prior is N(0, I).
#pragma once

#include <cmath>

#include "sim/noise_model.h"

namespace npdr::sim {

/// Const calls are thread-safe. Keeps a reference to the channel's noise.
class NoiseTransform {
 public:
  static constexpr Index kMostUnknown = 3;

  explicit NoiseTransform(const ChannelNoise& noise) : noise_(noise) {}

  /// How many are unknown, in the order scale, correlation, degrees of freedom.
  Index dimension() const {
    return (noise_.scale.is_unknown() ? 1 : 0) + (has_unknown_correlation() ? 1 : 0) +
           (has_unknown_degrees() ? 1 : 0);
  }

  /// Values at the unknown ones' z (dimension()).
  NoiseValues values(const Vector& z) const {
    Index next = 0;
    const auto moved = [&](const NoiseParameter& parameter) {
      return parameter.is_unknown() ? parameter.deviation * z(next++) : 0.0;
    };
    NoiseValues values;
    values.scale = noise_.scale.median * std::exp(moved(noise_.scale));
    if (noise_.is_correlated) {
      const double rho = noise_.correlation.median;
      const double odds = rho / (1.0 - rho) * std::exp(moved(noise_.correlation));
      values.correlation = odds / (1.0 + odds);
    }
    if (noise_.is_heavy_tailed) {
      const double least = noise_.degrees_of_freedom.median - 1.0;
      values.degrees_of_freedom = 1.0 + least * std::exp(moved(noise_.degrees_of_freedom));
    }
    return values;
  }

 private:
  bool has_unknown_correlation() const {
    return noise_.is_correlated && noise_.correlation.is_unknown();
  }
  bool has_unknown_degrees() const {
    return noise_.is_heavy_tailed && noise_.degrees_of_freedom.is_unknown();
  }

  const ChannelNoise& noise_;
};

}  // namespace npdr::sim
