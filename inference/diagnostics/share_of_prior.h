/// How much of the prior lies where a posterior is.
#pragma once

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// The share of N(0, I), which the prior of u is, within the ellipsoid around samples (n, D) of u
/// that holds 99 % of them. With their mean m, covariance L L^T and the 99 % quantile r of |L^-1 (u
/// - m)| it is
///   |det L| E[ phi(m + L z) / q(z) ],   z ~ q,
/// the mean over 10,000 draws, half of them of N(0, I) within the ball of radius r, as posteriors
/// that are wide need it, and half uniform in it, as those with heavy tails do: q is the density of
/// both together. 1 where the samples have no ellipsoid, since they are too few or don't vary.
double share_of_prior(const RowMatrix& samples, const StreamId& id);

}  // namespace npdr::inference
