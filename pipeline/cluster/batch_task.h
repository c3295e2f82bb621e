/// One task of a batch job: a program, run so that the batch system and it understand each other,
/// and the lines of its log.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// "npdr task: 17_3 on n2, 2024-03-01T12:00:00Z: npdr-simulate ...".
std::string begin_line(const std::string& id, const std::vector<std::string>& command);

/// "npdr task: exit status 1 after 12.3 s".
std::string end_line(int exit_status, double seconds);

/// How a task ended.
struct TaskEnd {
  int exit_status = 0;
  std::string words;  ///< "exit status 1 after 12.3 s: npdr-simulate: the disk is full"
};

/// The end of the task that wrote `log`; none: it didn't come to its end.
std::optional<TaskEnd> end_in_log(const std::filesystem::path& log);

/// Runs `command` with this process's output, and passes requests to stop on to it. Writes when it
/// began and how it ended, as above.
///
/// When it was stopped by SIGUSR1, which Slurm sends before the time limit (--signal=B:USR1@...),
/// the job is queued again, unless it was canceled as well. A second attempt that brought nothing
/// to the disk isn't: the next one would come no further. Returns the command's exit status, 128 +
/// the signal that ended it. Throws Error when the command can't be started.
int run_batch_task(const std::vector<std::string>& command);

}  // namespace npdr::pipeline
