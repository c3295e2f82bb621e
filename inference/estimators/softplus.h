/// softplus(a) = log(1 + e^a).
#pragma once

#include <Eigen/Core>

namespace npdr::inference {

/// Without overflow, vectorized; `a` is an Eigen array.
template <typename Derived>
auto softplus(const Eigen::ArrayBase<Derived>& a) {
  using S = typename Derived::Scalar;
  return a.max(S(0)) + (-a.abs()).exp().log1p();
}

}  // namespace npdr::inference
