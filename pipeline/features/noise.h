/// A study's observation noise, for the states that somebody looks at.
#pragma once

#include <vector>

#include "core/target.h"
#include "pipeline/config/study.h"
#include "sim/noise_model.h"

namespace npdr::pipeline {

/// Noise of the stored states of `target`, of all channels, or of `channels`.
sim::NoiseModel noise_model(const Study& study, const Target& target,
                            std::vector<Index> channels = {});

}  // namespace npdr::pipeline
