/// Where training reads x from: rows on demand, so that memory doesn't grow with their number.
#pragma once

#include <span>

#include "core/types.h"

namespace npdr::inference {

class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  virtual Index num_rows() const = 0;
  virtual Index num_features() const = 0;

  /// x of `rows`, (rows.size(), F), not standardized. `epoch` tells draws of fresh observation
  /// noise apart, for sources that have it; epoch 0 is the draw for validation.
  virtual void gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
                      RowMatrixF& x) const = 0;
};

}  // namespace npdr::inference
