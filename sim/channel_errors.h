/// Errors of one channel, recorded minus simulated, and their density under its noise. Private to
/// sim.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>

#include "sim/noise_model.h"
#include "sim/noise_transform.h"

namespace npdr::sim {

/// Errors of all states over a(h, c), each beside the one before it. Where the scale of their noise
/// may be unknown no likelihood takes them for smaller than the states' rounding: a simulation that
/// meets a recording exactly would have an unbounded one.
struct ChannelErrors {
  Eigen::ArrayXd now;
  Eigen::ArrayXd before;     ///< 0 where a segment begins
  double rounding = 0.0;     ///< its square
  double now_squared = 0.0;  ///< sums
  double product = 0.0;
  double before_squared = 0.0;
  double log_measure = 0.0;  ///< log |d y / d error|

  /// Sum of (now - rho before)^2.
  double squares(double rho) const {
    const double sum = now_squared - 2.0 * rho * product + rho * rho * before_squared;
    return std::max(sum, static_cast<double>(now.size()) * rounding);
  }
};

/// Of channel c in all rollouts (H, K, C) but `left_out`; -1: in all.
ChannelErrors channel_errors(const NoiseModel& model, std::span<const float> recorded,
                             std::span<const float> simulated, Index c, Index left_out);

/// What the noise at these values takes for independent draws of N(0, 1), as far as the density's
/// slope sees them: psi(e) / sqrt(I), with e = (now - rho before) / s, psi = -d log p / d e and its
/// variance I. For Gaussian noise that is e.
Eigen::ArrayXd scores(const ChannelNoise& noise, const NoiseValues& values,
                      const Eigen::ArrayXd& independent);

/// log of density times prior over the channel's unknown parameters, in the space where their prior
/// is N(0, I).
class ChannelIntegrand {
 public:
  /// Keeps references to both.
  ChannelIntegrand(const ChannelNoise& noise, const ChannelErrors& errors)
      : noise_(noise), errors_(errors), transform_(noise) {}

  Index dimension() const { return transform_.dimension(); }
  double operator()(const Vector& z) const;
  NoiseValues values(const Vector& z) const { return transform_.values(z); }
  /// Where the moments of the errors put the parameters.
  Vector guess() const;

 private:
  const ChannelNoise& noise_;
  const ChannelErrors& errors_;
  NoiseTransform transform_;
};

/// Where errors of that root mean square and correlation put the unknown parameters of a noise.
Vector guess_of(const ChannelNoise& noise, double size, double correlation);

}  // namespace npdr::sim
