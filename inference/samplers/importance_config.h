/// Settings of adaptive importance sampling, as a study gives them.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Most levels of a refinement: a checkpoint holds what counts of them.
inline constexpr Index kMostLevels = 10'000;
/// Fewest levels of a refinement: the first, one that it has taught, and a reported one.
inline constexpr Index kFewestLevels = 3;

struct ImportanceConfig {
  double likelihood_power = 1.0;      ///< a in (0, 1]
  bool cross_validate = false;        ///< a is the best power up to that, by leaving rollouts out
  Index level_size = 10'000;          ///< draws from one proposal
  double min_ess = 1000.0;            ///< of the reported levels
  Index max_simulations = 1'000'000;  ///< at most
};

}  // namespace npdr::inference
