/// Ranking by return.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// Positions of the `count` largest returns (of all, where there are fewer), the largest first; of
/// equal ones the first.
inline std::vector<Index> best_rows(const Vector& returns, Index count) {
  std::vector<Index> order(static_cast<std::size_t>(returns.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, [&](Index a, Index b) { return returns(a) > returns(b); });
  order.resize(static_cast<std::size_t>(std::min(count, returns.size())));
  return order;
}

}  // namespace npdr::inference
