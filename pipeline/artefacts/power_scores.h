/// Scores of the powers of a refined posterior's likelihood.
#pragma once

#include "pipeline/artefacts/layout.h"

namespace npdr::pipeline {

/// Powers of the likelihood that were tried, and how well the posterior given all rollouts but one
/// predicts that one.
struct PowerScores {
  Vector power;         ///< (k), ascending
  Vector noise_factor;  ///< (k) of the noise's unknown scales, for predictions
  RowMatrix crps;       ///< (k, H) of each rollout, mean over channels, with the best factor

  /// The number of the power whose mean over rollouts is least, of one or more.
  Index least() const;
  /// The score up to which a power predicts about as well as the best: worse by its standard error,
  /// or by 1 %. Of two or more rollouts.
  double as_good_as_any() const;
  /// Whether powers up to `most` that are larger than all of these might be better still.
  bool ends_at_least(double most) const;
  /// The standard error of a power's mean over rollouts, of two or more.
  double standard_error(Index power_number) const;
  /// The factor at the largest of these powers that isn't above `wanted`; 1 where there is none.
  double noise_factor_at(double wanted) const;
};

/// Members of the group `power_scores`. Throws InputError for sizes that differ.
void describe(Layout group, PowerScores& scores);

/// That group, where powers were tried.
void describe(Layout f, std::optional<PowerScores>& scores);

}  // namespace npdr::pipeline
