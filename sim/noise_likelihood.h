/// log p(recording | simulation), with the noise's unknown parameters integrated out.
///
/// With y the recorded and x the simulated states, both divided by the reference amplitude, so that
/// densities are unitless,
///   p(y | x) = prod_c int p(y_c | x_c, noise_c) p(noise_c) d noise_c.
/// A channel's integral, over one to three parameters in the space where their prior is N(0, I), is
/// taken by Gauss-Hermite quadrature around the integrand's mode with its curvature there (Liu and
/// Pierce 1994, "A note on Gauss-Hermite quadrature"; one node is Laplace's approximation). Without
/// heavy tails the density follows from three sums, whatever the number of states. Where the scale
/// is relative to the amplitude, errors (without heavy tails: their mean square) count for no less
/// than the rounding of single precision, 2^-24: else it would be 0 where x meets y.
#pragma once

#include <optional>

#include "sim/error_memory.h"
#include "sim/first_states.h"
#include "sim/noise_model.h"

namespace npdr::sim {

/// Const calls are thread-safe.
class NoiseLikelihood {
 public:
  /// `recorded`: (H, K, C) stored states. `first_states`: that simulations begin in where they are
  /// inferred; none: they are exact. Throws ShapeError for another size.
  NoiseLikelihood(NoiseModel model, std::vector<float> recorded,
                  std::optional<FirstStates> first_states = std::nullopt);

  const NoiseModel& model() const { return model_; }
  bool infers_first_states() const { return first_states_.has_value(); }
  /// Only where they are inferred.
  const FirstStates& first_states() const { return first_states_.value(); }
  /// Of simulations from now on: their errors (S, C), over a.
  void begin_without(RowMatrix errors) { first_states_.value().errors = std::move(errors); }

  /// Throws InputError where a channel has no noise, so that recordings have no density: its scale
  /// is 0, or relative to an amplitude of 0; and for heavy tails where first states are inferred.
  void require_density() const;

  /// log p(y | x) [nats] of one simulation (H, K, C), or (H (1 + C), K, C) where first states are
  /// inferred; -infinity unless all of it is finite.
  double log_likelihood(std::span<const float> simulated) const;
  /// The same of the rollouts but number `left_out`; -1: of all.
  double log_likelihood_without(Index left_out, std::span<const float> simulated) const;

  /// Parameters of all channels (C) given y and x: the unknown ones drawn from the Gaussian that
  /// has the posterior's mode and curvature, or from the prior where the channel has no noise.
  /// Rollout `left_out` isn't looked at. Where first states are inferred, simulations from recorded
  /// ones are off by what their noise does, which counts as noise here: scales that are given are
  /// drawn, too.
  std::vector<NoiseValues> draw_values(std::span<const float> simulated, Stream& stream,
                                       Index left_out = -1) const;

  /// The likeliest errors of first states (S, C), over a, given a simulation, with the noise's
  /// parameters at their mode, and what would be simulated without them, to first order.
  struct FirstStateFit {
    std::vector<NoiseValues> values;  ///< (C)
    RowMatrix errors;
    std::vector<float> states;  ///< (H, K, C)
  };
  FirstStateFit fit_first_states(std::span<const float> simulated) const;

  /// |e - e'| over all states of two simulations (H, K, C), e the independent errors of N(0, 1)
  /// that Gaussian noise at these values takes their errors for: no estimate that is as good as the
  /// noise lets it be moves by more of its deviations when one takes the place of the other.
  double distance(std::span<const float> one, std::span<const float> other,
                  const std::vector<NoiseValues>& values) const;

  /// |e|^2 of a simulation (H, K, C) that begins without first_states().errors, these included:
  /// what the likeliest first states make smallest. Gaussian noise at these values.
  double misfit(std::span<const float> simulated, const std::vector<NoiseValues>& values) const;

  /// How far errors are from the independence that the noise gives them, with its parameters, and
  /// first states where they are inferred, at the mode given x.
  ErrorMemory error_memory(std::span<const float> simulated) const;

 private:
  double sum_of_channels(Index left_out, std::span<const float> simulated) const;
  double joint_log_likelihood(Index left_out, std::span<const float> simulated) const;

  NoiseModel model_;
  std::vector<float> recorded_;
  std::optional<FirstStates> first_states_;
};

}  // namespace npdr::sim
