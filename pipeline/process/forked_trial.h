/// Doing something in a child process first, to see whether the process survives it.
#pragma once

#include <filesystem>
#include <functional>

#include "core/error.h"

namespace npdr::pipeline {

/// Runs `action` in a copy of this process and throws its results away: what it returns, throws and
/// prints. False when it doesn't come back: a library crashed (a signal such as SIGSEGV, or an exit
/// of its own), used a minute of processor time, or took `time_limit` seconds. True, too, when it
/// can't be found out. `action` must not use threads, and no other thread may hold what it needs.
bool survives(const std::function<void()>& action, unsigned time_limit = 600);

/// The error of an HDF5 file that can't be survived.
InputError damaged_file(const std::filesystem::path& path);

}  // namespace npdr::pipeline
