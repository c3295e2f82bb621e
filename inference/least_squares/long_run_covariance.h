/// Covariance of a sum of vectors that depend on those near them in time (Newey and West 1987),
/// with the number of lags by Andrews (1991, eqs. 6.2 and 6.4).
///
/// Vectors g_t (D) of H series of K steps each, t = 1, ..., K, with mean 0:
///   Cov(sum g) = c^2 sum over series, t, s of max(0, 1 - |t - s| / L) g_t g_s^T.
/// The sum is too small where few stretches of L steps are there. With b = L / (H K) and
///   c = 1 + 1.3289 b + 0.1910 b^2 - 0.2083 b^3
/// 90 % intervals of one series hold .90 (Kiefer and Vogelsang 2005, table 1, Bartlett); several
/// series count as one of H K steps.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// L [steps], from 1 to K, by autoregressions of order one of each column of g (H K, D).
Index num_lags(const RowMatrix& g, Index num_series);

/// The sum above, (D, D), positive semidefinite. g: (H K, D), series by series.
RowMatrix long_run_covariance(const RowMatrix& g, Index num_series, Index num_lags);

}  // namespace npdr::inference
