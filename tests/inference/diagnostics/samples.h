/// Samples with known distributions.
#pragma once

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// n rows of N(mean, deviation^2 I) in D dimensions; `mean` is that of every column.
inline RowMatrix gaussian(Index n, Index d, std::uint64_t seed, double mean = 0.0,
                          double deviation = 1.0) {
  Stream stream({seed, "gaussian", 0, 0, 0});
  return RowMatrix::NullaryExpr(n, d,
                                [&](Index, Index) { return mean + deviation * stream.normal(); });
}

}  // namespace npdr::inference
