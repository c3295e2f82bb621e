/// The main function of the stage executables.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// What one stage executable is.
struct StageProgram {
  std::string name;           ///< such as "npdr-simulate"
  std::string description;    ///< for --help
  std::vector<Stage> stages;  ///< those that it runs, in this order
};

/// Makes the missing artefacts of the program's stages whose inputs are there.
int stage_main(const StageProgram& program, int argc, char** argv);

}  // namespace npdr::pipeline
