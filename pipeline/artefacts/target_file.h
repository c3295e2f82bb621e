/// Target artefacts: rollouts (recording.h), or x_o where the simulator gives features.
#pragma once

#include "core/target.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// Writes rollouts with their numbers. Throws Error.
void write_rollouts(h5::File& file, const Target& target);

/// Writes x_o: the state after the only step of the only rollout. Throws Error.
void write_observation(h5::File& file, const Target& target);

/// The target, whichever of both it is. Throws InputError.
Target read_target_artefact(const ArtefactFile& target);

}  // namespace npdr::pipeline
