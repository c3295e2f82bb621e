/// Settings of approximate Bayesian computation, as a study gives them.
#pragma once

#include "core/enum_names.h"

namespace npdr::inference {

/// Distance of a simulation from the target: of features, or a metric of trajectories.
enum class AbcDistance { euclidean, dtw, rmse };
constexpr auto enum_table(AbcDistance) {
  using enum AbcDistance;
  return std::to_array<EnumRow<AbcDistance>>(
      {{euclidean, "euclidean"}, {dtw, "dtw"}, {rmse, "rmse"}});
}

struct AbcConfig {
  AbcDistance distance = AbcDistance::euclidean;
  double quantile = 0.1;  ///< of distances: the threshold epsilon
  /// Threshold of distances. 0: by the quantile alone; > 0: this or, for "abc_smc", the one that
  /// its thresholds end at.
  double epsilon = 0.0;
  bool smooth = false;  ///< posterior samples are moved by the density's kernel
};

}  // namespace npdr::inference
