/// Rows are evaluated in blocks of fixed size, the last one padded: a row's bits then depend
/// neither on how many others there are nor on the thread that computes it.
#pragma once

#include <algorithm>
#include <functional>

#include "core/parallel.h"
#include "core/types.h"

namespace npdr::inference {

inline constexpr Index kBlockRows = 64;

inline Index num_blocks(Index rows) { return (rows + kBlockRows - 1) / kBlockRows; }

/// One value of each row of `u` (n, D), n >= 1, into `result` (n): `evaluate(block, values)` gets
/// kBlockRows rows at a time, on any thread.
inline void evaluate_in_blocks(
    const RowMatrixF& u,
    const std::function<void(const RowMatrixF& block, VectorF& values)>& evaluate, Vector& result) {
  const Index n = u.rows();
  result.resize(n);
  parallel_for(num_blocks(n), [&](Index b) {
    const Index rows = std::min(kBlockRows, n - b * kBlockRows);
    RowMatrixF block(kBlockRows, u.cols());
    block.topRows(rows) = u.middleRows(b * kBlockRows, rows);
    block.bottomRows(kBlockRows - rows).rowwise() = u.row(n - 1);
    VectorF values;
    evaluate(block, values);
    result.segment(b * kBlockRows, rows) = values.head(rows).cast<double>();
  });
}

}  // namespace npdr::inference
