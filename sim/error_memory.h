/// Whether errors follow each other where a noise model has them independent.
///
/// A likelihood that takes n errors for independent believes n of them, however many say the same.
/// With z_k their scores, of mean 0 and variance 1 under the model (channel_errors.h), the slope of
/// the log likelihood has a variance that is tau <z^2> times the one that the model gives it:
///   tau = 1 + 2 sum_l rho_l,    rho_l = sum_k z_k z_{k+l} / sum_k z_k^2,
/// over pairs of the same segment, the sum ended, after the first term, where rho_2m + rho_2m+1
/// isn't above two standard errors of independent z, 2 sqrt(2 / N) (where it is above 0: Geyer
/// 1992, "Practical Markov chain Monte Carlo"). A posterior whose model is wrong should be wider by
/// the root of it (Huber 1967; Müller 2013, "Risk of Bayesian inference in misspecified models, and
/// the sandwich covariance matrix"), here with the same tau for all parameters.
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::sim {

struct ErrorMemory {
  Index num_errors = 0;  ///< of a channel
  Vector memory;         ///< (C) tau: how many errors say what one does
  Vector size;           ///< (C) <z^2>

  /// The largest tau <z^2> of a channel, and which it is; NaN is large.
  double excess() const;
  Index worst_channel() const;
};

/// `scores`: (N, C), of states one after the other; `restarts` (N): whether a state is the first of
/// its segment. A score that is 0 throughout has memory 1.
ErrorMemory memory_of(const RowMatrix& scores, const std::vector<char>& restarts);

/// The excess above which n errors of the worst of C channels hardly are independent draws of the
/// noise: 1 and 8 + log C of its standard errors.
double largest_by_chance(Index num_errors, Index num_channels);

}  // namespace npdr::sim
