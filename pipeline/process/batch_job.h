/// The batch job that a process is a part of, and how its task learns whether what it ran has
/// brought anything to the disk.
#pragma once

#include <string>

namespace npdr::pipeline {

/// The id of the task, as Slurm ("17", "17_3" in an array), PBS, LSF or Grid Engine give it to a
/// job's environment; NPDR_JOB_ID comes before them all. Empty: none.
std::string batch_job_id();

/// The same of Slurm alone.
std::string slurm_task_id();

/// The variable that names the mark's file to the programs of a task.
inline constexpr const char* kTaskMark = "NPDR_TASK_MARK";

/// Makes the mark, if this process is a part of a task: an artefact, shard or checkpoint is there
/// now. Never throws.
void mark_progress() noexcept;

}  // namespace npdr::pipeline
