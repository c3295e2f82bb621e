/// Description of a study's simulator, built-in or not, and settings of a loaded library.
#pragma once

#include "pipeline/config/study.h"
#include "sim/library/library_simulator.h"

namespace npdr::pipeline {

/// Describes the study's simulator. A built-in one does so itself. A command or a dataset has the
/// parameters of the prior, then those of simulator.parameters, without limits and with the unit 1;
/// the features of x are the state channels of a single step. Throws InputError for a name that no
/// built-in simulator has.
sim::SimulatorInfo simulator_info(const Study& study);

/// The library of simulator.library with its settings; for simulator.mjcf npdr's own library for
/// MuJoCo, whose settings are the model and the names of parameters and channels. Throws InputError
/// when npdr was built without MuJoCo.
sim::LibraryConfig library_config(const Study& study);

}  // namespace npdr::pipeline
