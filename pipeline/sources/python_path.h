/// Where Python finds our modules for users' programs.
#pragma once

#include <string>

namespace npdr::pipeline {

/// PYTHONPATH for a user's program: the folder of npdr_worker.py and npdr_command.py, beside that
/// of the executables, before what it is already.
std::string python_path();

}  // namespace npdr::pipeline
