/// One call of a shell command, with a time limit.
#pragma once

#include <string>

#include "core/shell_process.h"

namespace npdr {

struct ShellCall {
  ShellCommand command;
  double time_limit = 0.0;  ///< [s]
};

struct CallResult {
  int exit_status = 0;     ///< 128 + signal number when a signal ended it
  bool timed_out = false;  ///< it was ended after its time limit
  double seconds = 0.0;
  std::string output;  ///< of stdout and stderr; of a long one beginning and end, 16 KiB each

  bool succeeded() const { return exit_status == 0 && !timed_out; }
  /// "exit status 1 after 0.5 s", "signal 11 (Segmentation fault) after 0.5 s", "ended after its
  /// time limit of 2 s".
  std::string words(double time_limit) const;
};

/// Runs the command in a process group of its own, with nothing on its standard input, until it
/// ends or its time is over; then nothing of the group is left. Throws Checkpointed when this
/// process is asked to stop (stop_request.h), after the group has been ended; Error when no process
/// can be started. SIGTERM comes first, SIGKILL a second later.
CallResult run_shell(const ShellCall& call);

}  // namespace npdr
