#include "inference/abc/acceptance.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "core/error.h"

namespace npdr::inference {

Accepted accept_nearest(const Vector& distances, double quantile) {
  std::vector<Index> order(static_cast<std::size_t>(distances.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::erase_if(order, [&](Index row) { return !std::isfinite(distances(row)); });
  const auto wanted =
      static_cast<std::size_t>(std::ceil(quantile * static_cast<double>(distances.size()) - 1e-9));
  const std::size_t count = std::min(std::max<std::size_t>(wanted, 1), order.size());
  if (count == 0) return {};
  const auto is_nearer = [&](Index a, Index b) {
    return distances(a) != distances(b) ? distances(a) < distances(b) : a < b;
  };
  const auto last = order.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::nth_element(order.begin(), last, order.end(), is_nearer);
  const double epsilon = distances(*last);
  order.resize(count);
  std::sort(order.begin(), order.end());
  return {order, epsilon};
}

Accepted accept_within(const Vector& distances, double epsilon) {
  Accepted accepted{{}, epsilon};
  for (Index row = 0; row < distances.size(); ++row) {
    if (distances(row) <= epsilon) accepted.rows.push_back(row);
  }
  return accepted;
}

Accepted accept_first(const Vector& distances, const AbcConfig& config) {
  return config.epsilon > 0.0 ? accept_within(distances, config.epsilon)
                              : accept_nearest(distances, config.quantile);
}

void require_enough(const Accepted& accepted, const Vector& distances, Index dimension) {
  const auto found = static_cast<Index>(accepted.rows.size());
  if (found > dimension) return;
  const Index num_good = distances.array().isFinite().count();
  std::ostringstream message;
  message << "ABC accepted " << found << " of " << distances.size()
          << " simulations (epsilon = " << accepted.epsilon << "), must be > " << dimension
          << ", the number of parameters; ";
  if (num_good > dimension || num_good == distances.size()) {
    message << "raise abc.quantile, abc.epsilon or num_simulations";
  } else {
    message << distances.size() - num_good << " failed: narrow the prior to where they don't";
  }
  throw Error(message.str());
}

}  // namespace npdr::inference
