/// Rows of x in blocks, for sums over all of them in little memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "inference/feature_source.h"

namespace npdr::inference {

/// Rows of a block, at most.
inline constexpr Index kRowsOfBlock = 500;
/// Simulations that are looked at for properties of features which few rows tell.
inline constexpr Index kFirstRows = 2000;

/// Calls `body(begin, rows)` for blocks of the first `num_rows` rows of x, as they are in epoch 0:
/// `rows` (kRowsOfBlock or fewer, F) are those from number `begin` on.
template <class Body>
void for_each_block(const FeatureSource& x, Index num_rows, const Body& body) {
  RowMatrixF rows;
  for (Index begin = 0; begin < num_rows; begin += kRowsOfBlock) {
    std::vector<std::uint32_t> indices(
        static_cast<std::size_t>(std::min(kRowsOfBlock, num_rows - begin)));
    std::iota(indices.begin(), indices.end(), static_cast<std::uint32_t>(begin));
    x.gather(indices, 0, rows);
    body(begin, rows);
  }
}

}  // namespace npdr::inference
