/// First states that are recorded with noise, as all others are.
///
/// The recorded first state y_0 of a segment is the true one plus the noise's error eta_0. The
/// segment is simulated from y_0 - epsilon. To first order around there, with x_k simulated and J_k
/// its derivative by the first state,
///   y_k - x_k = eta_k - J_k (eta_0 - epsilon),
/// so that the errors of a segment's states have eta_0 in common, and channels depend on each
/// other. eta is the noise of noise_model.h without heavy tails, but stationary, as it doesn't
/// begin with the segment:
///   eta_k = rho_c eta_{k-1} + s_c a_c e_k,    eta_0 ~ N(0, s_c^2 a_c^2 / (1 - rho_c^2)),
/// and eta_0, whose density given all others is Gaussian, is integrated out in closed form. J comes
/// from differences: further rollouts whose first states are moved a little, one for each channel.
/// epsilon = 0 unless first order is too coarse there, as next to a kink: a device with dry
/// friction that is let go at rest answers to a push otherwise than to a pull. Then it is the
/// likeliest eta_0. Segments count as independent, although one begins where another ends.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/target.h"
#include "sim/noise_model.h"

namespace npdr::sim {

/// How far states are moved for differences, (H, C): by the noise's size, but at most 2^-9 of the
/// largest recorded value, and by no less than 2^-13 of it, above the rounding of single precision.
RowMatrix first_state_moves(const NoiseModel& model);

/// Where segments are simulated from.
struct FirstStates {
  RowMatrix moves;   ///< (H, C) to the further rollouts
  RowMatrix errors;  ///< epsilon over a, (S, C), row after row of a rollout's segments
};

/// epsilon = 0.
FirstStates recorded_first_states(const NoiseModel& model);

/// H (1 + C) rollouts: those of `target` without the errors of their segments' first states, then
/// for each channel c again, with its states moved by moves(h, c). `segment_length` as of the
/// simulations.
Target begun_at(const FirstStates& first, const NoiseModel& model, const Target& target,
                Index segment_length);

/// Errors y_k - x_k of a simulation as sums over the states of a segment, and what follows
/// from them for any values of the noise.
class FirstStateErrors {
 public:
  /// `recorded`: (H, K, C). `simulated`: (H (1 + C), K, C), of begun_at(). Rollout `left_out` isn't
  /// looked at; -1: all are. Throws ShapeError.
  FirstStateErrors(const NoiseModel& model, std::span<const float> recorded,
                   std::span<const float> simulated, const FirstStates& first, Index left_out = -1);

  /// All values are finite.
  bool are_finite() const;
  /// log p [nats] of the recorded states over measure(), given values (C) of the noise; NaN where
  /// channels are so alike that rounding hides how they differ.
  double log_density(const std::vector<NoiseValues>& values) const;
  /// Root mean square of the errors (C), over a.
  Vector size() const;
  /// Correlation (C) of an error with the one before it.
  Vector correlation() const;
  /// Means (S, C) of eta_0 given the recorded states and values (C) of the noise, over a, a row a
  /// segment of the rollouts that are looked at.
  RowMatrix first_errors(const std::vector<NoiseValues>& values) const;

 private:
  // Sums over the states of a segment of products of v_k = (r_k, J_k), r the error of one channel
  // and J (C) its derivatives: eta_k = r_k + J_k (eta_0 - epsilon). v_0 = (epsilon, 1 at the
  // channel) is that of the first state itself.
  struct Sums {
    Eigen::MatrixXd now;      // v_k v_k^T
    Eigen::MatrixXd product;  // v_k v_{k-1}^T + v_{k-1} v_k^T
    Eigen::MatrixXd before;   // v_{k-1} v_{k-1}^T
    void add(const Vector& v, const Vector& last) {
      now.noalias() += v * v.transpose();
      product.noalias() += v * last.transpose();
      product.noalias() += last * v.transpose();
      before.noalias() += last * last.transpose();
    }
    // The same of v_k - rho v_{k-1}.
    Eigen::MatrixXd whitened(double rho) const { return now - rho * product + rho * rho * before; }
  };
  // The Gaussian of a segment's eta_0 - epsilon: its precision, and that times its mean.
  struct Gaussian {
    Eigen::MatrixXd precision;
    Vector shift;
  };

  Index num_segments() const { return std::ssize(sums_) / num_channels_; }
  const Sums& sums(Index segment, Index channel) const {
    return sums_[static_cast<std::size_t>(segment * num_channels_ + channel)];
  }
  Gaussian gaussian(Index segment, const std::vector<NoiseValues>& values, double* squares) const;

  Index num_channels_;
  std::vector<Sums> sums_;    // (S, C)
  RowMatrix begun_;           // epsilon over a, (S, C)
  Vector num_states_;         // (C) that are looked at
  Vector rounding_;           // (C) of a state, its square over a^2; 0 of channels in their unit
  double log_measure_ = 0.0;  // log |d y / d error|
};

/// What the simulation (H, K, C) would be from first states without `errors` (S, C) of
/// FirstStateErrors, to first order. `simulated` and `first` as there.
std::vector<float> from_first_states(const NoiseModel& model, std::span<const float> simulated,
                                     const FirstStates& first, const RowMatrix& errors);

}  // namespace npdr::sim
