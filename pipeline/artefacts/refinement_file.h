/// Certificates of refined posteriors, and checkpoints of refinements.
#pragma once

#include "inference/samplers/importance_sampler.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

/// First states that a refinement's simulations begin in, where it infers them.
struct FirstStateMoves {
  RowMatrix first_errors;  ///< (S, C) as SimulatedLikelihood::first_errors()
  Index count = 0;         ///< how often they have been moved
  Index num_draws = 0;     ///< simulated until they were, the last time
};

/// Parts of the artefact of a refined posterior: its certificate, what it leaves of its recording
/// where that is known, and its first states unless they are exact.
void describe(Layout f, std::optional<inference::ImportanceCertificate>& certificate);
void describe(Layout f, std::optional<sim::ErrorMemory>& residuals);
void describe(Layout f, std::optional<FirstStateMoves>& moves);

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
