/// Grids for sums that stand for integrals.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Centers (side^2, 2) of the cells that a rectangle is cut into, in rows along the second axis.
inline RowMatrix cells_of(const Eigen::Array2d& low, const Eigen::Array2d& high, Index side) {
  RowMatrix centers(side * side, 2);
  const Eigen::Array2d width = (high - low) / static_cast<double>(side);
  for (Index i = 0; i < centers.rows(); ++i) {
    const Eigen::Array2d cell(static_cast<double>(i / side), static_cast<double>(i % side));
    centers.row(i) = (low + width * (cell + 0.5)).matrix().transpose();
  }
  return centers;
}

}  // namespace npdr::inference
