/// The kinds of sources, one a file. Each throws InputError for a study that it can't be made of.
#pragma once

#include <memory>

#include "pipeline/sources/source.h"

namespace npdr::pipeline {

/// The simulators of sim/.
std::unique_ptr<Source> make_built_in_source(const Study& study);

/// A program of the user's: a command that exchanges files, or a worker that answers requests
/// (external_simulator.h). Reads the files that its command names, and simulator.files.
std::unique_ptr<Source> make_program_source(const Study& study);

/// A shared library of the user's, or npdr's own for models of MuJoCo. Loads it.
std::unique_ptr<Source> make_library_source(const Study& study);

/// A finished dataset: theta and x that somebody has simulated elsewhere.
std::unique_ptr<Source> make_dataset_source(const Study& study);

}  // namespace npdr::pipeline
