/// Noise: the model of how a recorded state differs from its simulation.
///
/// The error of stored state k = 1, ..., K of channel c in rollout h, recorded minus simulated, is
///   r[k] = rho_c r[k - 1] + s_c a(h, c) e[k],    r = 0 where a segment begins,
/// with independent e of N(0, 1) or, with heavy tails, of Student's t with nu_c degrees of freedom.
/// The scale s_c is unitless where a(h, c) is the channel's reference_amplitude(), and in the
/// channel's unit where a = 1. A parameter is given, or unknown with a prior:
///   log s ~ N(log median, deviation^2),            s > 0
///   logit rho ~ N(logit median, deviation^2),      0 < rho < 1
///   log(nu - 1) ~ N(log(median - 1), deviation^2), nu > 1
/// Unknown ones are drawn anew for every simulation, and integrated out of the likelihood: there
/// are three at most in a channel, and given a simulation channels are independent, unless first
/// states are inferred (first_states.h).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::sim {

/// States are kept in single precision, so none is known better than to this share of the largest.
inline constexpr double kStateRounding = 0x1p-24;

/// A number that is given, or unknown.
struct NoiseParameter {
  double median = 0.0;     ///< the number itself where it is given
  double deviation = 0.0;  ///< of the prior, in the space above; 0: given
  bool is_unknown() const { return deviation > 0.0; }
};

/// Noise of one channel.
struct ChannelNoise {
  NoiseParameter scale = {};               ///< s >= 0
  bool is_in_unit = false;                 ///< a = 1
  bool is_correlated = false;              ///< else rho = 0
  NoiseParameter correlation = {};         ///< rho in [0, 1)
  bool is_heavy_tailed = false;            ///< else e ~ N(0, 1)
  NoiseParameter degrees_of_freedom = {};  ///< nu > 1
};

/// Values of the parameters of one channel.
struct NoiseValues {
  double scale = 0.0;
  double correlation = 0.0;
  double degrees_of_freedom = 0.0;  ///< of heavy tails only
};

/// Where the stored states of a rollout lie: `restarts` (K), whether a state is the first of its
/// segment.
std::vector<char> stored_restarts(Index num_steps, Index segment_length, Index store_every);

/// Noise of series of H rollouts, K stored states and C channels. Const calls are thread-safe.
class NoiseModel {
 public:
  /// `amplitude`: (H, C), the reference_amplitude() of the channels. Throws ShapeError unless there
  /// is a column for each channel, InputError for values out of range.
  NoiseModel(std::vector<ChannelNoise> channels, RowMatrix amplitude, std::vector<char> restarts);

  const std::vector<ChannelNoise>& channels() const { return channels_; }
  const std::vector<char>& restarts() const { return restarts_; }
  Index num_rollouts() const { return unit_.rows(); }
  Index num_steps() const { return static_cast<Index>(restarts_.size()); }
  Index num_states() const { return unit_.cols(); }

  /// a(h, c), and what recorded states are measured in by the likelihood: the reference amplitude,
  /// 1 where that is 0.
  const RowMatrix& unit() const { return unit_; }
  const RowMatrix& measure() const { return measure_; }

  bool is_silent() const;  ///< all scales are 0: there is no noise
  /// Whether the channel has noise in every rollout, so that its states have a density.
  bool has_density(Index channel) const;
  bool has_unknown() const;  ///< some parameter has a prior

  /// The same noise, whose scales that are given, but for 0, are medians of priors one e-fold wide.
  NoiseModel with_unknown_scales() const;

  /// Root mean square of the noise over a rollout's states, over measure(), (H, C); of what isn't
  /// known with its median. Student's t without a variance, nu <= 2, counts as Gaussian.
  RowMatrix relative_size() const;

  /// Parameters of all channels (C), the unknown ones drawn from their priors.
  std::vector<NoiseValues> draw_values(Stream& stream) const;
  /// Values (C) whose scales are `factor` times as large where they are unknown.
  std::vector<NoiseValues> with_unknown_scales_times(double factor,
                                                     std::vector<NoiseValues> values) const;

  /// log p [nats] of the error of state k of channel c in rollout h alone, over measure(), of known
  /// noise with a density: N(0, d^2) with d^2 = s^2 a^2 sum_i rho^2i over the states since the
  /// restart, or Student's t with that scale, which is exact for one of rho = 0 and next to a
  /// restart.
  double log_marginal(Index h, Index k, Index c, double error, const NoiseValues& values) const;

  /// Adds noise to every `stride`-th of the stored states, (H, floor(K / stride), C). Unknown
  /// parameters are drawn first. The noise is a function of the stream's identity and the shapes
  /// alone; NaN stays NaN. Throws ShapeError.
  void add(std::span<float> series, Index stride, Stream& stream) const;
  /// The same with known values, of all stored states.
  void add(std::span<float> series, const std::vector<NoiseValues>& values, Stream& stream) const;

 private:
  double growth(Index k, double correlation) const;  // sum_i rho^2i over the states since a restart
  void add_dependent(std::span<float> series, Index stride, const std::vector<NoiseValues>& values,
                     Stream& stream) const;

  std::vector<ChannelNoise> channels_;
  RowMatrix unit_;
  RowMatrix measure_;
  std::vector<char> restarts_;
  std::vector<Index> age_;  // (K) of a state, in states since the restart before it: 1, 2, ...
};

}  // namespace npdr::sim
