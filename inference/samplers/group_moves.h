/// Metropolis steps that tell repeated draws of a density apart.
#pragma once

#include "core/random.h"
#include "inference/samplers/log_density.h"

namespace npdr::inference {

/// Moves the rows of u (n, D), which are draws of the density, or nearly so, and may repeat each
/// other, and leaves the density invariant. In a sweep either half of the rows takes a step
///   u_i + g (u_j - u_k) + N(0, 1e-6 I),   g = 2.38 / sqrt(2 D) e^N(0, 1/4)
/// with two rows of the other half (ter Braak 2006, "A Markov chain Monte Carlo version of the
/// genetic algorithm differential evolution"), which stand still meanwhile. Halves are chosen anew
/// each time. Where fewer rows differ than a few times D, they need far more than 30 sweeps. With
/// fewer than 4 rows nothing moves. A row where the density is NaN stays.
void move_group(RowMatrix& u, const LogDensity& log_density, Index num_sweeps, Stream& stream);

}  // namespace npdr::inference
