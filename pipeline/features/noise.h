/// A study's observation noise, for the states that somebody looks at.
#pragma once

#include "inference/embeddings/embedding.h"
#include "pipeline/config/study.h"
#include "sim/noise_model.h"

namespace npdr::pipeline {

/// Noise of the stored states of `target`, of all channels.
sim::NoiseModel noise_model(const Study& study, const Target& target);

/// Noise of the stored states of the channels that an embedding picks.
sim::NoiseModel noise_model(const Study& study, const Target& target,
                            const inference::SeriesSelection& selection);

}  // namespace npdr::pipeline
