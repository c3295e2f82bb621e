#include "inference/diagnostics/bound_pressure.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace npdr::inference {

BoundPressure test_bounds(Vector v) {
  const Index n = v.size();
  if (n < kFewestForBounds) {
    throw InputError("bounds: " + std::to_string(n) + " samples, must be at least " +
                     std::to_string(kFewestForBounds));
  }
  std::sort(v.begin(), v.end());
  const double below = v(n - 1 - n / 10), above = v(n / 10);
  const double width = below - above;
  const double edge = BoundPressure::kEdge * width;
  const auto share = [&](const auto& is_inside) {
    return static_cast<double>(is_inside.count()) / static_cast<double>(n);
  };
  return {.lower = share(v.array() < edge),
          .upper = share(v.array() > 1.0 - edge),
          .below = below,
          .above = above,
          .lowest = share(v.array() < BoundPressure::kTail),
          .highest = share(v.array() > 1.0 - BoundPressure::kTail),
          .is_narrow = width < BoundPressure::kNarrow};
}

}  // namespace npdr::inference
