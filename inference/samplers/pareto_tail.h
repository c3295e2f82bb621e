/// Shape of the tail of importance weights.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// k of the generalized Pareto distribution that fits the largest min(0.2 n, 3 sqrt n) of the
/// weights (n) >= 0 (Zhang and Stephens 2009, with the prior of Vehtari et al. 2024, "Pareto
/// smoothed importance sampling"). Means by these weights have a finite variance below 0.5, and are
/// of use below 0.7; above, the largest weights that there are haven't been seen. Infinite for
/// fewer than five weights in the tail, or where they are all the same but 0.
double pareto_k(const Vector& weights);

}  // namespace npdr::inference
