/// Certificates of refined posteriors, and checkpoints of refinements.
#pragma once

#include "inference/samplers/importance_sampler.h"
#include "pipeline/artefacts/posterior_file.h"

namespace npdr::pipeline {

/// Throws Error.
void write_certificate(h5::File& file, const inference::ImportanceCertificate& certificate);
/// None: the posterior wasn't refined. Throws InputError.
std::optional<inference::ImportanceCertificate> read_certificate(const h5::File& file);

/// What a refinement leaves of its recording, where that is known. Throws Error.
void write_residuals(h5::File& file, std::optional<sim::ErrorMemory> residuals);
/// None: it isn't, or the posterior wasn't refined. Throws InputError.
std::optional<sim::ErrorMemory> read_residuals(const h5::File& file);

/// First states that a refinement's simulations begin in, where it infers them.
struct FirstStateMoves {
  RowMatrix first_errors;  ///< (S, C) as SimulatedLikelihood::first_errors()
  Index count = 0;         ///< how often they have been moved
  Index num_draws = 0;     ///< simulated until they were, the last time
};
/// Throws Error.
void write_first_states(h5::File& file, std::optional<FirstStateMoves> moves);
/// None: the posterior wasn't refined, or its first states are exact. Throws InputError.
std::optional<FirstStateMoves> read_first_states(const h5::File& file);

/// State that an interrupted refinement goes on from.
struct RefinementCheckpoint {
  inference::ImportanceState state;
  std::optional<FirstStateMoves> moves = {};  ///< none: first states are exact
  Index num_failed = 0;                       ///< simulations so far
  PowerScores powers;
  Cost cost;  ///< of the work that led here
};
/// Writes the checkpoint of the posterior `identity`. Throws Error.
void write_refinement(const std::filesystem::path& path, const Identity& identity,
                      RefinementCheckpoint checkpoint);
/// An empty state when there is no checkpoint. Throws InputError for a damaged one.
RefinementCheckpoint read_refinement(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
