/// What the recording says of the noise, as evaluations keep it.
#pragma once

#include <optional>

#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/predictions/scores.h"

namespace npdr::pipeline {

/// `noise`: that of the samples' predictions, `seen`: their rollouts. NaN of samples that failed,
/// whose values are the prior's. None where all parameters of the noise are given.
std::optional<InferredNoise> inferred_noise(const sim::NoiseModel& model,
                                            const NoiseOfSamples& noise,
                                            const sim::Trajectories& seen);

}  // namespace npdr::pipeline
