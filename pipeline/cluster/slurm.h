/// Slurm, through its commands: the only file that knows their options and what they print.
///
/// There is no lasting record to trust: a controller that crashed forgets its last submissions and
/// gives their ids again. So a job says in its comment what it makes, and what is queued is asked
/// from Slurm itself.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::pipeline {

/// A task that waits or runs; a job that isn't an array is one task.
struct QueuedTask {
  std::string job;             ///< id of the job or of the array
  std::optional<Index> index;  ///< in the array
  std::string state;           ///< "PENDING", "RUNNING", ...
  std::string reason;          ///< why it waits: "Dependency", "Resources", ...
  std::string node;            ///< where it runs
  std::string comment;

  /// "17" or "17_3".
  std::string id() const { return index ? job + "_" + std::to_string(*index) : job; }
  bool is_running() const { return state != "PENDING"; }
};

/// A job or an array to be submitted.
struct Submission {
  std::filesystem::path script;
  std::string array;                   ///< "0-3,7%2"; empty: no array
  std::vector<std::string> after_ok;   ///< ids of jobs that must have succeeded
  std::vector<std::string> after_any;  ///< ids of jobs that must have ended
  std::vector<std::string> options;    ///< further words for sbatch
  std::vector<std::string> after;      ///< ids of jobs that must have begun
};

/// The words of the command that submits it.
std::vector<std::string> sbatch_command(const Submission& submission);

/// Submits; the job's id. Throws Error with what Slurm said and what to do about it.
std::string submit_to_slurm(const Submission& submission);

/// All tasks of this user that wait or run; one that is being cleaned up makes nothing any more.
/// Throws Error when Slurm doesn't answer.
std::vector<QueuedTask> queued_tasks();

/// One line of squeue as queued_tasks() asks for it: a task, or all tasks of an array that wait;
/// none: it isn't such a line.
std::vector<QueuedTask> parse_queued_tasks(const std::string& line);

/// "1,5-7,10-20:5%4", as Slurm writes the indices of an array; none for what isn't such a text.
std::vector<Index> parse_indices(const std::string& text);

/// One more than the largest index that an array may have. Throws Error when Slurm doesn't say.
Index max_array_size();

/// Ends jobs and tasks that wait or run. Throws Error.
void cancel_in_slurm(const std::vector<std::string>& ids);

/// The words of the command that queues the running job or task `id` again from inside of it.
std::vector<std::string> requeue_command(const std::string& id);

/// The state that Slurm remembers of a task that has ended, such as "TIMEOUT"; empty: nothing. It
/// forgets most after minutes where it keeps no accounts. Throws Error when no process can be
/// started.
std::string ended_state(const std::string& id);

}  // namespace npdr::pipeline
