/// Global minimization over a box whose objective is evaluated a whole population at a time.
///
/// Differential evolution (Storn and Price 1997) in the self-adapting form JADE (Zhang and
/// Sanderson 2009, "JADE: adaptive differential evolution with optional external archive", eqs.
/// 5-12, Table I):
///   v_i = x_i + F_i (x_pbest - x_i) + F_i (x_r1 - x_r2)
///   u_i = v_i in coordinates chosen with probability CR_i and in one random coordinate, else x_i
///   x_i <- u_i  where f(u_i) <= f(x_i)
/// with F_i and CR_i drawn around means that follow what succeeded. A coordinate of v_i outside the
/// box is put on its border: minima on the border are found exactly.
#pragma once

#include <cstdint>
#include <functional>

#include "core/types.h"

namespace npdr::analysis {

/// Values (n) of the objective at n points (n, D), one a row. Simulating many parameter sets costs
/// little more than one. A value that isn't finite says that the point is of no use.
using BatchObjective = std::function<Vector(const RowMatrix& points)>;

struct DifferentialEvolutionConfig {
  Index population = 128;       ///< points per generation, at least 4
  Index max_generations = 600;  ///< after the first population
  double tolerance = 1e-4;      ///< stop when (worst - best) of the population <= this * |best|
  std::uint64_t seed = 0;
  std::uint64_t restart = 0;  ///< searches of another number draw other random numbers
};

/// The end of a search.
struct DifferentialEvolutionResult {
  RowMatrix points;  ///< (population, D), best first
  Vector values;     ///< (population), ascending; +infinity where the objective isn't finite
  Index num_evaluations = 0;
};

/// Minimizes over the unit cube [0, 1]^D. The first population is a Latin hypercube whose first
/// rows are replaced by those of `start` (k, D), as many as fit, so that the result is never worse
/// than the best of these. The same bits for the same seed, restart and objective. Throws
/// InputError for a config out of range, and ShapeError when the objective returns another number
/// of values than it was given points, or `start` has rows but not D columns.
DifferentialEvolutionResult differential_evolution(const BatchObjective& objective, Index dimension,
                                                   const RowMatrix& start,
                                                   const DifferentialEvolutionConfig& config);

}  // namespace npdr::analysis
