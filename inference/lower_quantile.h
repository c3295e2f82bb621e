/// Quantiles that are values of the sample, where interpolation would mix unlike ones.
#pragma once

#include <cstddef>
#include <vector>

namespace npdr::inference {

/// Of n values, ascending, the one at place floor(p (n - 1)), p in [0, 1], n >= 1.
template <class T>
T lower_quantile(const std::vector<T>& sorted, double p) {
  return sorted[static_cast<std::size_t>(p * static_cast<double>(sorted.size() - 1))];
}

}  // namespace npdr::inference
