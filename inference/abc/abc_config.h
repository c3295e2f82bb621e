/// Settings of approximate Bayesian computation, as a study gives them.
#pragma once

#include <string>
#include <vector>

namespace npdr::inference {

struct AbcConfig {
  std::string distance = "euclidean";  ///< a name of distance_names()
  double quantile = 0.1;               ///< of distances: the threshold epsilon
  /// Of distances. 0: the quantile alone; > 0: the threshold itself or, for "abc_smc", where its
  /// thresholds end.
  double epsilon = 0.0;
  bool smooth = false;  ///< posterior samples are moved by the density's kernel
};

/// "euclidean" (of features), and metrics of trajectories: "dtw", "rmse".
std::vector<std::string> distance_names();

}  // namespace npdr::inference
