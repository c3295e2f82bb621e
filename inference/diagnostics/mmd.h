/// Maximum mean discrepancy of two samples (Gretton et al. 2012, "A kernel two-sample test"), the
/// unbiased estimate of eq. 3:
///   MMD^2 = sum_{i != j} k(x_i, x_j) / (n (n - 1)) + sum_{i != j} k(y_i, y_j) / (m (m - 1))
///           - 2 sum_{i, j} k(x_i, y_j) / (n m),
/// with k(a, b) = exp(-|a - b|^2 / (2 s^2)) and s the median distance between pooled rows. Rows are
/// standardized by mean and deviation of both samples together, so that neither units nor which of
/// the two is first matter.
///
/// The p-value is that of a permutation test: rows are dealt to the two samples at random, which is
/// exact for samples of any size when both come from the same distribution.
#pragma once

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Settings of the permutation test.
struct MmdConfig {
  Index num_permutations = 200;
};

/// The estimate, and how improbable it is for samples of the same distribution.
struct Mmd {
  double squared = 0.0;    ///< near 0, also below it, for samples of the same distribution
  double p_value = 1.0;    ///< (1 + permutations at least as large) / (1 + permutations)
  double bandwidth = 0.0;  ///< s, in deviations of the pooled rows
};

/// Compares two samples (n, D) and (m, D). Kernels are computed in tiles: memory grows with n + m,
/// not with its square. The bits don't depend on the number of threads. Throws ShapeError when the
/// columns differ and InputError for fewer than 10 rows, or what isn't finite.
Mmd mmd(const RowMatrix& first, const RowMatrix& second, const StreamId& id,
        const MmdConfig& config = {});

}  // namespace npdr::inference
