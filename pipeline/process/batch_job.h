/// The batch job that a process is a part of.
#pragma once

#include <string>

namespace npdr::pipeline {

/// The id of the task, as Slurm ("17", "17_3" in an array), PBS, LSF or Grid Engine give it to a
/// job's environment; NPDR_JOB_ID comes before them all. Empty: none.
std::string batch_job_id();

/// The same of Slurm alone.
std::string slurm_task_id();

}  // namespace npdr::pipeline
