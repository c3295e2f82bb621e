/// Source of x for training: rows on demand, so that memory doesn't grow with their number.
#pragma once

#include <span>

#include "core/types.h"

namespace npdr::inference {

/// N simulations, the failed ones left out, each of F features.
class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  virtual Index num_rows() const = 0;      ///< N
  virtual Index num_features() const = 0;  ///< F

  /// x of `rows`, (rows.size(), F), not standardized. `epoch` tells draws of fresh observation
  /// noise apart, for sources that have it; epoch 0 is the draw for validation.
  virtual void gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
                      RowMatrixF& x) const = 0;
};

}  // namespace npdr::inference
