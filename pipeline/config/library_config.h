/// Settings that a study's library, or model of MuJoCo, is loaded with.
#pragma once

#include "pipeline/config/study.h"
#include "sim/library/library_simulator.h"

namespace npdr::pipeline {

/// The library of simulator.library with its settings; for simulator.mjcf npdr's own library for
/// MuJoCo, whose settings are the model and the names of parameters and channels. Throws InputError
/// when npdr was built without MuJoCo.
sim::LibraryConfig library_config(const Study& study);

}  // namespace npdr::pipeline
