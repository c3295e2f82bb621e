/// Training checkpoints: what an interrupted training goes on from.
#pragma once

#include <vector>

#include "inference/training/trainer.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// States that interrupted trainings go on from.
struct Checkpoint {
  std::vector<inference::TrainingState> trainings;  ///< one a network; empty: not begun
  Cost cost;                                        ///< of the work that led here
};
/// Writes the checkpoint of the posterior `identity`. Throws Error.
void write_checkpoint(const std::filesystem::path& path, const Identity& identity,
                      Checkpoint checkpoint);
/// No states when there is no checkpoint. Throws InputError for a damaged one.
Checkpoint read_checkpoint(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
