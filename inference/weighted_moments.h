/// Moments of weighted samples.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// (sum w)^2 / sum w^2: how many equally weighted samples tell as much (Kong, Liu and Wong 1994).
double effective_size(const Vector& weights);

/// sum_i w_i x_i / sum w, (D). x: (n, D), weights (n) >= 0.
Vector weighted_mean(const RowMatrix& x, const Vector& weights);

/// sum_i w_i (x_i - mean)(x_i - mean)^T / (sum w - sum w^2 / sum w), (D, D): unbiased, and with
/// equal weights the usual one with n - 1. NaN when one sample has all of the weight.
Eigen::MatrixXd weighted_covariance(const RowMatrix& x, const Vector& weights);

/// weighted_covariance() of points that may be few, or hardly vary in a column: its diagonal is
/// larger by 1e-12 and 1e-9 of itself, which lets it be factored.
Eigen::MatrixXd regularized_covariance(const RowMatrix& x, const Vector& weights);

}  // namespace npdr::inference
