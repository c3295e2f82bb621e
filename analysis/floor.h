/// The floor of a study: the smallest value that an objective (an RMSE, say) takes anywhere in the
/// prior's box. No posterior can be better than it, so it says how much of a posterior's error is
/// the simulator's.
///
/// Derivative-free, in two stages: a global search per restart (analysis/differential_evolution.h)
/// that evaluates a whole population at a time, then a local one from its best point that finishes
/// the digits: BOBYQA (Powell 2009) for smooth objectives and Subplex (Rowan 1990) for those with
/// kinks, one after the other, both from NLopt (Johnson). Distances are measured in units of the
/// box.
#pragma once

#include <cstdint>

#include "analysis/differential_evolution.h"
#include "core/types.h"

namespace npdr::analysis {

struct FloorConfig {
  Index num_restarts = 3;              ///< global searches; the best one counts
  Index population = 128;              ///< points per generation of a global search
  Index max_generations = 600;         ///< of a global search
  double global_tolerance = 1e-4;      ///< relative spread of a population that ends its search
  Index max_local_evaluations = 2000;  ///< of each local search
  double local_step = 0.02;            ///< first step of a local search, as a share of the box
  double local_tolerance = 1e-7;       ///< step that ends a local search, as a share of the box
  std::uint64_t seed = 0;
};

struct FloorResult {
  Vector theta;           ///< (D) where the smallest value was found
  double value = 0.0;     ///< the objective there
  Vector restart_values;  ///< (num_restarts) the best of each: they agree when the search is sound
  Index num_evaluations = 0;
};

/// Minimizes `objective` over lower <= theta <= upper (D each). The rows of `starting_points` (k,
/// D), such as nominal values and earlier best fits, join the first population of the first
/// restart; they may be none. Points where the objective isn't finite are avoided. The same bits
/// for the same seed. What the objective throws comes out unchanged. Throws ShapeError for sizes
/// that don't agree; InputError for a box that is empty or infinite, a starting point outside it,
/// or a config out of range; Error when the objective is finite nowhere.
FloorResult find_floor(const BatchObjective& objective, const Vector& lower, const Vector& upper,
                       const RowMatrix& starting_points, const FloorConfig& config = {});

}  // namespace npdr::analysis
