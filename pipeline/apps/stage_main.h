/// The main function of the stage executables, which are links to `npdr`.
#pragma once

#include <string>

namespace npdr::pipeline {

/// Whether a stage's executable has that name (plan/stage.h).
bool is_stage_program(const std::string& program);

/// Makes the missing artefacts of the stages whose executable is `program`, where their inputs
/// are there. Returns the exit status.
int stage_main(const std::string& program, int argc, char** argv);

}  // namespace npdr::pipeline
