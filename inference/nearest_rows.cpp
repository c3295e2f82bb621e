#include "inference/nearest_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace npdr::inference {

std::vector<Index> nearest_rows(const RowMatrix& rows, Index i, Index count) {
  Vector distances = (rows.rowwise() - rows.row(i)).rowwise().squaredNorm();
  for (double& d : distances) d = std::isfinite(d) ? d : std::numeric_limits<double>::max();
  std::vector<Index> order(static_cast<std::size_t>(rows.rows()));
  std::iota(order.begin(), order.end(), 0);
  order.erase(order.begin() + i);
  const Index kept = std::min(count, std::ssize(order));
  const auto is_nearer = [&](Index a, Index b) {
    return std::pair(distances(a), a) < std::pair(distances(b), b);
  };
  std::ranges::nth_element(order, order.begin() + kept, is_nearer);
  order.resize(static_cast<std::size_t>(kept));
  return order;
}

}  // namespace npdr::inference
