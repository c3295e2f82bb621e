/// The prior in the space of u: its density, and draws of it.
#pragma once

#include <cmath>

#include "core/constants.h"
#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// log N(u; 0, I) of each row of u (n, D), in nats.
template <typename S>
VectorX<S> log_standard_normal(const RowMatrixX<S>& u) {
  const double constant = -0.5 * kLogTwoPi * static_cast<double>(u.cols());
  return (S(-0.5) * u.rowwise().squaredNorm()).array() + static_cast<S>(constant);
}

/// (n, D) draws of N(0, I); row i is of the stream `id` with that row further.
inline RowMatrix draw_standard_normal(Index n, Index dimension, StreamId id) {
  RowMatrix u(n, dimension);
  for (Index i = 0; i < n; ++i, ++id.row) {
    Stream stream(id);
    for (double& value : u.row(i)) value = stream.normal();
  }
  return u;
}

}  // namespace npdr::inference
