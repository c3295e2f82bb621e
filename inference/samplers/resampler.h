/// Draws from weighted candidates by inversion of their distribution function.
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// Const calls are thread-safe.
class Resampler {
 public:
  /// weights (n) >= 0, at least one > 0; they need not sum to 1.
  explicit Resampler(const Vector& weights);

  /// The candidate at `uniform` in (0, 1).
  Index draw(double uniform) const;
  /// `count` candidates at (i + uniform) / count, ascending (systematic resampling).
  std::vector<Index> systematic(Index count, double uniform) const;
  double effective_size() const { return effective_size_; }

 private:
  Vector cumulative_;
  double effective_size_;
};

}  // namespace npdr::inference
