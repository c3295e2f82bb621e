/// Logarithms of sums of exponentials, without overflow: with the largest m of the values,
///   log sum_i exp(x_i) = m + log sum_i exp(x_i - m).
#pragma once

#include <span>

#include "core/types.h"

namespace npdr {

/// Of values (n), n >= 1; the largest itself where that isn't finite.
double log_sum_exp(const Eigen::Ref<const Vector>& values);
float log_sum_exp(const Eigen::Ref<const VectorF>& values);

/// log 1/n sum_i exp(x_i) of values (n), n >= 1.
double log_mean_exp(const Eigen::Ref<const Vector>& values);

/// Of each row of the terms, which are vectors of one size, one or more; -infinity where all are.
Vector log_sum_exp_of_terms(std::span<const Vector> terms);

/// Of each row of x (n, k), k >= 1, as an array (n); NaN where all are -infinity.
template <typename Derived>
auto log_sum_exp_of_rows(const Eigen::MatrixBase<Derived>& x) {
  using S = typename Derived::Scalar;
  Eigen::Array<S, Eigen::Dynamic, 1> largest = x.col(0), sum;
  for (Index c = 1; c < x.cols(); ++c) largest = largest.max(x.col(c).array());
  sum.setZero(x.rows());
  for (Index c = 0; c < x.cols(); ++c) sum += (x.col(c).array() - largest).exp();
  return (largest + sum.log()).eval();
}

}  // namespace npdr
