#include "inference/algorithms/ratio_loss.h"

#include <algorithm>
#include <cmath>

#include "inference/algorithms/atomic_loss.h"

namespace npdr::inference {
namespace {

double softplus(double a) { return std::max(a, 0.0) + std::log1p(std::exp(-std::abs(a))); }
double sigmoid(double a) { return 1.0 / (1.0 + std::exp(-a)); }

}  // namespace

template <typename S>
double binary_ratio_loss(const VectorX<S>& logits, VectorX<S>& d_logits) {
  const Index n = logits.size() / 2;
  const double scale = 1.0 / static_cast<double>(n);
  d_logits.resize(logits.size());
  double loss = 0.0;
  for (Index i = 0; i < n; ++i) {
    const auto own = static_cast<double>(logits(2 * i));
    const auto other = static_cast<double>(logits(2 * i + 1));
    loss += scale * (softplus(-own) + softplus(other));
    d_logits(2 * i) = static_cast<S>(-scale * sigmoid(-own));
    d_logits(2 * i + 1) = static_cast<S>(scale * sigmoid(other));
  }
  return loss;
}

template <typename S>
double categorical_ratio_loss(const VectorX<S>& logits, Index k, VectorX<S>& d_logits) {
  return atomic_loss<S>(logits, VectorX<S>::Zero(logits.size()), k, d_logits);
}

template double binary_ratio_loss(const VectorX<float>&, VectorX<float>&);
template double binary_ratio_loss(const VectorX<double>&, VectorX<double>&);
template double categorical_ratio_loss(const VectorX<float>&, Index, VectorX<float>&);
template double categorical_ratio_loss(const VectorX<double>&, Index, VectorX<double>&);

}  // namespace npdr::inference
