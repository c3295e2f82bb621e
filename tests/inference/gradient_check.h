/// Compares a gradient with central differences in double precision.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Checks `count` entries of `gradient` (all when there are fewer) at `point`. The step 1e-5 leaves
/// a truncation error of about 1e-10 and a rounding error of about 1e-11 in each difference.
inline void expect_gradient(const std::function<double(const Vector&)>& function,
                            const Vector& point, const Vector& gradient, Index count = 400) {
  constexpr double step = 1e-5;
  Stream stream({7, "gradient_check", 0, 0, 0});
  const bool all = point.size() <= count;
  for (Index i = 0; i < std::min(count, point.size()); ++i) {
    const Index entry =
        all ? i : static_cast<Index>(stream.below(static_cast<std::uint32_t>(point.size())));
    Vector above = point, below = point;
    above(entry) += step;
    below(entry) -= step;
    const double difference = (function(above) - function(below)) / (2.0 * step);
    ASSERT_NEAR(gradient(entry), difference, 1e-7 + 1e-6 * std::abs(difference))
        << "entry " << entry;
  }
}

inline RowMatrix random_matrix(Index rows, Index cols, std::uint64_t seed) {
  Stream stream({seed, "random_matrix", 0, 0, 0});
  return RowMatrix::NullaryExpr(rows, cols, [&](Index, Index) { return stream.normal(); });
}

}  // namespace npdr::inference
