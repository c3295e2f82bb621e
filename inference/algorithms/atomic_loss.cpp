#include "inference/algorithms/atomic_loss.h"

#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/log_sum_exp.h"

namespace npdr::inference {

std::vector<std::uint32_t> draw_atoms(Index n, Index k, Stream& stream) {
  if (k > n) {
    throw ShapeError("draw_atoms: " + std::to_string(k) + " atoms of a batch of " +
                     std::to_string(n));
  }
  const auto count = static_cast<std::uint32_t>(n);
  std::vector<std::uint32_t> atoms;
  atoms.reserve(static_cast<std::size_t>(n * k));
  std::vector<std::uint32_t> pool(count);
  for (std::uint32_t i = 0; i < count; ++i) pool[i] = i;
  for (std::uint32_t i = 0; i < count; ++i) {
    // Fisher and Yates on a pool whose first place holds the row itself. The pool stays a
    // permutation from row to row, so it need not be reset.
    for (std::uint32_t j = 0; j < count; ++j) {
      if (pool[j] == i) std::swap(pool[0], pool[j]);
    }
    for (std::uint32_t a = 1; a < static_cast<std::uint32_t>(k); ++a) {
      std::swap(pool[a], pool[a + stream.below(count - a)]);
    }
    atoms.insert(atoms.end(), pool.begin(), pool.begin() + k);
  }
  return atoms;
}

template <typename S>
double atomic_loss(const VectorX<S>& log_prob, const VectorX<S>& log_prior, Index k,
                   VectorX<S>& d_log_prob) {
  const Index n = log_prob.size() / k;
  d_log_prob.resize(log_prob.size());
  double loss = 0.0;
  for (Index i = 0; i < n; ++i) {
    auto ratio = d_log_prob.segment(i * k, k);
    ratio = log_prob.segment(i * k, k) - log_prior.segment(i * k, k);
    const S log_sum = log_sum_exp(ratio);
    loss += static_cast<double>(log_sum - ratio(0));
    ratio = (ratio.array() - log_sum).exp();  // dloss/dratio is softmax - (1, 0, ..., 0)
    ratio(0) -= S(1);
    ratio /= static_cast<S>(n);
  }
  return loss / static_cast<double>(n);
}

template double atomic_loss<float>(const VectorF&, const VectorF&, Index, VectorF&);
template double atomic_loss<double>(const Vector&, const Vector&, Index, Vector&);

}  // namespace npdr::inference
