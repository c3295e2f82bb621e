/// Certificates of refined posteriors, and checkpoints of refinements.
#pragma once

#include "inference/samplers/importance_sampler.h"
#include "pipeline/artefacts/schemas.h"
#include "sim/error_memory.h"

namespace npdr::pipeline {

/// First states that a refinement's simulations begin in, where it infers them.
struct FirstStateMoves {
  RowMatrix first_errors;  ///< (S, C) as SimulatedLikelihood::first_errors()
  Index count = 0;         ///< how often they have been moved
  Index num_draws = 0;     ///< simulated until they were, the last time
};

/// Parts of a refined posterior: its certificate, the residuals of its recording where they are
/// known, and its first states unless they are exact.
void describe(Layout f, std::optional<inference::ImportanceCertificate>& certificate);
void describe(Layout f, std::optional<sim::ErrorMemory>& residuals);
void describe(Layout f, std::optional<FirstStateMoves>& moves);

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

/// State that an interrupted refinement goes on from.
struct RefinementCheckpoint {
  inference::ImportanceState state;
  std::optional<FirstStateMoves> moves = {};  ///< none: first states are exact
  Index num_failed = 0;                       ///< simulations so far
  PowerScores powers;
  Cost cost;  ///< of the work that led here
};
void describe(Layout f, RefinementCheckpoint& checkpoint);

}  // namespace npdr::pipeline
