/// Training checkpoints: what an interrupted training goes on from.
#pragma once

#include <vector>

#include "inference/training/trainer.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

/// States that interrupted trainings go on from.
struct TrainingCheckpoint {
  std::vector<inference::TrainingState> trainings;  ///< one a network; empty: not begun
  Cost cost;                                        ///< of the work that led here
};
void describe(Layout f, TrainingCheckpoint& checkpoint);

}  // namespace npdr::pipeline
