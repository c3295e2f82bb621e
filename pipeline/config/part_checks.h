/// Rules between the settings of one part of a study, and between them and the simulator. What is
/// wrong is added to `reading`. `info`: the simulator's, nullptr where that isn't known. Private to
/// pipeline/config.
#pragma once

#include "pipeline/config/problems.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Of the study's i-th method; fills in the density estimator that its algorithm has by default.
void check_method(Study& study, std::size_t i, const sim::SimulatorInfo* info, Reading& reading);

/// Of the observation noise.
void check_noise(const Study& study, const sim::SimulatorInfo* info, Reading& reading);

/// The closed-loop task of the study's simulator, the names of its policy's and domain parameters,
/// the grid, and settings of another optimizer.
void check_policy(const Study& study, const sim::SimulatorInfo* info, Reading& reading);

}  // namespace npdr::pipeline
