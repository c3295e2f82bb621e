/// Rules between the settings of a method, and between them and the simulator. Private to
/// pipeline/config.
#pragma once

#include "pipeline/config/problems.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Adds what is wrong with the study's i-th method to `reading`; fills in the density estimator
/// that its algorithm has by default. `info`: the simulator's, nullptr where that isn't known.
void check_method(Study& study, std::size_t i, const sim::SimulatorInfo* info, Reading& reading);

}  // namespace npdr::pipeline
