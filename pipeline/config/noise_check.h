/// Rules between the settings of the observation noise. Private to pipeline/config.
#pragma once

#include "pipeline/config/problems.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Adds what is wrong with the study's noise to `reading`. `info`: the simulator's, nullptr where
/// that isn't known.
void check_noise(const Study& study, const sim::SimulatorInfo* info, Reading& reading);

}  // namespace npdr::pipeline
