/// Dense layers on batches: y = x W + b, with x (m, in), W (in, out), b (1, out).
#pragma once

#include <cassert>
#include <cmath>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Row i of `rows` (m, w) = row i n / m of `groups` (n, w): each as often as the others. m: a
/// multiple of n.
template <typename G, typename R>
void repeat_groups(const G& groups, Index m, R& rows) {
  assert(m % groups.rows() == 0);
  if (m == groups.rows()) {
    rows = groups;
    return;
  }
  const Index k = m / groups.rows();
  rows.resize(m, groups.cols());
  for (Index outer = 0; outer < rows.outerSize(); ++outer) {
    if constexpr (R::IsRowMajor) {
      rows.row(outer) = groups.row(outer / k);
    } else {
      for (Index g = 0; g < groups.rows(); ++g) {
        rows.col(outer).segment(g * k, k).setConstant(groups(g, outer));
      }
    }
  }
}

/// y = x W + b.
template <typename X, typename W, typename B, typename Y>
void dense(const X& x, const W& weight, const B& bias, Y& y) {
  repeat_groups(bias, x.rows(), y);
  y.noalias() += x * weight;
}

/// y = tanh(x W + b).
template <typename X, typename W, typename B, typename Y>
void dense_tanh(const X& x, const W& weight, const B& bias, Y& y) {
  dense(x, weight, bias, y);
  y = y.array().tanh();
}

/// y = max(0, x W + b).
template <typename X, typename W, typename B, typename Y>
void dense_relu(const X& x, const W& weight, const B& bias, Y& y) {
  using S = typename Y::Scalar;
  dense(x, weight, bias, y);
  y = y.cwiseMax(S(0));
}

/// dL/dW = x^T dL/dy and dL/db = sum over rows of dL/dy, overwritten.
template <typename X, typename D, typename W, typename B>
void dense_gradient(const X& x, const D& d_y, W&& d_weight, B&& d_bias) {
  d_weight.noalias() = x.transpose() * d_y;
  d_bias.row(0) = d_y.colwise().sum();
}

/// Given y = tanh(a), turns dL/dy in `d` into dL/da.
template <typename Y, typename D>
void tanh_backward(const Y& y, D& d) {
  using S = typename Y::Scalar;
  d.array() *= S(1) - y.array().square();
}

/// Given y = max(0, a), turns dL/dy in `d` into dL/da. A loop, because Eigen 3.4's select() isn't
/// vectorized.
template <typename S>
void relu_backward(const RowMatrixX<S>& y, RowMatrixX<S>& d) {
  const S* value = y.data();
  S* derivative = d.data();
  const Index count = d.size();
#pragma omp simd
  for (Index i = 0; i < count; ++i) derivative[i] = value[i] > S(0) ? derivative[i] : S(0);
}

/// Row g of `groups` (n, w) = sum of the rows g k, ..., g k + k - 1 of `rows` (n k, w).
template <typename R, typename G>
void sum_groups(const R& rows, G&& groups) {
  assert(rows.rows() % groups.rows() == 0);
  if (rows.rows() == groups.rows()) {
    groups = rows;
    return;
  }
  const Index k = rows.rows() / groups.rows();
  for (Index g = 0; g < groups.rows(); ++g) {
    groups.row(g) = rows.middleRows(g * k, k).colwise().sum();
  }
}

/// Weight and bias uniform on +-scale / sqrt(inputs) (LeCun et al. 1998, "Efficient BackProp").
template <typename W, typename B>
void initialize_dense(W&& weight, B&& bias, Stream& stream, double scale = 1.0) {
  using S = typename std::decay_t<W>::Scalar;
  const double bound = scale / std::sqrt(static_cast<double>(weight.rows()));
  const auto draw = [&] { return static_cast<S>(bound * (2.0 * stream.uniform() - 1.0)); };
  for (Index i = 0; i < weight.rows(); ++i) {
    for (Index j = 0; j < weight.cols(); ++j) weight(i, j) = draw();
  }
  for (Index j = 0; j < bias.cols(); ++j) bias(0, j) = draw();
}

}  // namespace npdr::inference
