/// The density of the prior in the space of u.
#pragma once

#include <cmath>
#include <numbers>

#include "core/types.h"

namespace npdr::inference {

/// log N(u; 0, I) of each row of u (n, D), in nats.
template <typename S>
VectorX<S> log_standard_normal(const RowMatrixX<S>& u) {
  const double constant = -0.5 * std::log(2.0 * std::numbers::pi) * static_cast<double>(u.cols());
  return (S(-0.5) * u.rowwise().squaredNorm()).array() + static_cast<S>(constant);
}

}  // namespace npdr::inference
