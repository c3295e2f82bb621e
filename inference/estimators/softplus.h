/// softplus(a) = log(1 + e^a), and the scales that networks give by it.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace npdr::inference {

/// The least scale: a network's output a gives softplus(a + kScaleOffset) + kSmallestScale, which
/// is 1 where a is 0.
inline constexpr double kSmallestScale = 1e-3;
inline const double kScaleOffset = std::log(std::expm1(1.0 - kSmallestScale));

/// Without overflow, vectorized; `a` is an Eigen array.
template <typename Derived>
auto softplus(const Eigen::ArrayBase<Derived>& a) {
  using S = typename Derived::Scalar;
  return a.max(S(0)) + (-a.abs()).exp().log1p();
}

}  // namespace npdr::inference
