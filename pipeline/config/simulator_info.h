/// What a study's simulator is about, built-in or not.
#pragma once

#include "pipeline/config/study.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// What the study's simulator is about. Of a built-in one, what it says itself. Of a command or a
/// dataset: the parameters of the prior, then those of simulator.parameters, without limits and
/// with the unit 1; the features of x as the state channels of a single step.
sim::SimulatorInfo simulator_info(const Study& study);

}  // namespace npdr::pipeline
