/// Checks of [policy] that need more than one key.
#pragma once

#include "pipeline/config/problems.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// The closed-loop task of the study's simulator, the names of its policy's and domain parameters,
/// the grid, and settings of another optimizer. `info`: the simulator's, where it is known.
void check_policy(const Study& study, const sim::SimulatorInfo* info, Reading& reading);

}  // namespace npdr::pipeline
