/// The density that a sampler draws from.
#pragma once

#include <functional>

#include "core/types.h"

namespace npdr::inference {

/// log p(u) but for a constant, in nats, of the rows of u: (n, D) -> (n). A row's value must not
/// depend on the others. NaN counts as -infinity.
using LogDensity = std::function<Vector(const RowMatrix& u)>;

}  // namespace npdr::inference
