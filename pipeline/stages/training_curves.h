/// The check of training, of all networks of a posterior.
#pragma once

#include "inference/diagnostics/training_check.h"
#include "pipeline/artefacts/posterior_file.h"

namespace npdr::pipeline {

/// Of the network that has learned least: one that isn't converged, or has the largest gap.
/// Networks of a pool's likelihood count where they aren't converged: their power, by held-out
/// simulations, makes up for a gap, and where it is 0 they say nothing. `notes`: of networks.
inference::TrainingCheck check_training_curves(const PosteriorNotes& notes,
                                               const inference::TrainingConfig& config);

}  // namespace npdr::pipeline
