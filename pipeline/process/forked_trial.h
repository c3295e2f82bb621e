/// Doing something in a child process first, to see whether the process survives it.
#pragma once

#include <filesystem>
#include <functional>

namespace npdr::pipeline {

/// What became of an action in a child process.
enum class Ending { came_back, crashed, ran_out_of_time };

struct TrialLimits {
  unsigned cpu_seconds = 60;  ///< of processor time
  unsigned seconds = 600;     ///< of all
};

/// Runs `action` in a copy of this process and throws its results away: what it returns, throws and
/// prints. It crashed when a library did (a signal such as SIGSEGV, or an exit of its own), and
/// came back when it can't be found out. `action` must not use threads, and no other thread may
/// hold what it needs.
Ending try_in_child(const std::function<void()>& action, const TrialLimits& limits = {});

/// Tries to read an HDF5 file that anybody may have made, for as long as its size may need. Throws
/// InputError where `read` crashes or comes to no end.
void try_to_read(const std::filesystem::path& path, const std::function<void()>& read);

}  // namespace npdr::pipeline
