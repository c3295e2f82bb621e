/// Certificates of refined posteriors, and checkpoints of refinements.
#pragma once

#include "inference/samplers/importance_sampler.h"
#include "pipeline/artefacts/posterior_file.h"

namespace npdr::pipeline {

/// Throws Error.
void write_certificate(h5::File& file, const inference::ImportanceCertificate& certificate);
/// None: the posterior wasn't refined. Throws InputError.
std::optional<inference::ImportanceCertificate> read_certificate(const h5::File& file);

/// Powers of the likelihood that were tried, and how well the posterior given all rollouts but one
/// predicts that one.
struct PowerScores {
  Vector power;         ///< (k), ascending
  Vector noise_factor;  ///< (k) of the noise's unknown scales, that predicts best
  RowMatrix crps;       ///< (k, H) with noise of each rollout, mean over channels

  /// The factor at the largest of these powers that isn't above `wanted`; 1 where there is none.
  double noise_factor_at(double wanted) const;
};

/// Throws Error.
void write_power_scores(h5::File& file, PowerScores scores);
/// Empty where the power wasn't chosen. Throws InputError.
PowerScores read_power_scores(const h5::File& file);

/// State that an interrupted refinement goes on from.
struct RefinementCheckpoint {
  inference::ImportanceState state;
  Index num_failed = 0;  ///< simulations so far
  PowerScores powers;
  Cost cost;  ///< of the work that led here
};
/// Writes the checkpoint of the posterior `identity`. Throws Error.
void write_refinement(const std::filesystem::path& path, const Identity& identity,
                      RefinementCheckpoint checkpoint);
/// An empty state when there is no checkpoint. Throws InputError for a damaged one.
RefinementCheckpoint read_refinement(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
