/// Nearest neighbors among the rows of a matrix.
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// The numbers of the `count` rows, or of all others, that are nearest to row i of `rows` (n, D) by
/// their Euclidean distance, in no order. Of equally near ones those of the smaller numbers; a row
/// whose distance isn't finite is the farthest. O(n D).
std::vector<Index> nearest_rows(const RowMatrix& rows, Index i, Index count);

}  // namespace npdr::inference
