/// Noise of a recording, by itself: how far neighboring samples scatter around the motion.
///
/// The p-th differences of a smooth motion are small, those of white noise of variance sigma^2 have
/// the variance binom(2p, p) sigma^2 (von Neumann 1941; Hall, Kay and Titterington 1990). So
///   sigma^2 = min over p = 1, ..., 5 of mean_t (D^p y_t)^2 / binom(2p, p)
/// bounds white noise from above, whatever the motion; noise that stays for many samples, as that
/// of filters, may be larger. Of white noise in n samples the root is off by some 1 / sqrt(n).
#pragma once

#include "core/target.h"
#include "core/types.h"

namespace npdr::analysis {

/// sigma of a series (n), in its unit; 0 of one that stands still, or of fewer than 10 samples.
double scatter(const Vector& series);

/// The same of the channel that scatters most, as an RMSE (metrics.h): over the largest magnitude
/// of the rollout's channel, in the mean over rollouts. Of others it may be too small: rates that
/// were computed or filtered hardly scatter, whatever their noise.
double scatter_of(const Target& recording);

}  // namespace npdr::analysis
