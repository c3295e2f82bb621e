/// Training checkpoints: what an interrupted training goes on from.
#pragma once

#include "inference/training/trainer.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// State that an interrupted training goes on from.
struct Checkpoint {
  inference::TrainingState training;
  Cost cost;  ///< of the work that led here
};
/// Writes the checkpoint of the posterior `identity`. Throws Error.
void write_checkpoint(const std::filesystem::path& path, const Identity& identity,
                      Checkpoint checkpoint);
/// An empty state when there is no checkpoint. Throws InputError for a damaged one.
Checkpoint read_checkpoint(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
