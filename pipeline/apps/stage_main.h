/// The main function of the stage executables.
#pragma once

#include <string>

namespace npdr::pipeline {

/// Makes the missing artefacts of the stages whose executable is `program` (plan/stage.h), where
/// their inputs are there. Returns the exit status.
int stage_main(const std::string& program, int argc, char** argv);

}  // namespace npdr::pipeline
