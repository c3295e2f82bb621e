/// One task of a batch job: a program, run so that the batch system and it understand each other.
#pragma once

#include <string>
#include <vector>

namespace npdr::pipeline {

/// Runs `command` with this process's output, and passes requests to stop on to it. Writes when it
/// began and how it ended (task_log.h).
///
/// When it was stopped by SIGUSR1, which Slurm sends before the time limit (--signal=B:USR1@...),
/// the job is queued again, unless it was canceled as well. A second attempt that brought nothing
/// to the disk isn't: the next one would come no further. Returns the command's exit status, 128 +
/// the signal that ended it. Throws Error when the command can't be started.
int run_batch_task(const std::vector<std::string>& command);

}  // namespace npdr::pipeline
