/// The Gaussian that policies are explored with.
#pragma once

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// sum_i w_i (x_i - center)(x_i - center)^T / sum w, (Q, Q). x: (n, Q), weights (n) >= 0.
RowMatrix scatter_around(const Vector& center, const RowMatrix& x, const Vector& weights);

/// The covariance with standard deviations of at least `min_std` in every direction: eigenvalues
/// below min_std^2 become that. Symmetric and positive definite, though few samples span fewer
/// dimensions than there are.
RowMatrix with_min_std(const RowMatrix& covariance, double min_std);

/// n draws of N(mean, covariance), (n, Q); draw i depends on `id` and i alone, which takes the
/// place of id.row. Throws Error unless the covariance is positive definite.
RowMatrix draw_gaussian(const Vector& mean, const RowMatrix& covariance, Index n,
                        const StreamId& id);

}  // namespace npdr::inference
