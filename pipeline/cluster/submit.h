/// Submits what a study misses to Slurm.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/cluster/job.h"
#include "pipeline/cluster/slurm.h"

namespace npdr::pipeline {

/// The jobs that are missing, given what Slurm has of the study already. Throws InputError for a
/// damaged shard, Error when a truth can't be simulated.
std::vector<Job> missing_jobs(const Plan& plan, std::optional<Stage> until,
                              const std::vector<QueuedTask>& queued, Index max_array_size);

/// Scripts of all jobs, and the commands that would submit them, in which JOB_1 stands for the id
/// of the first one. `options`: further words for sbatch. Throws InputError as job_script().
std::string dry_run_text(const Plan& plan, const std::vector<Job>& jobs,
                         const std::vector<std::string>& options);

/// Writes the scripts to a new folder of <work>/<study>/jobs, submits them in order and notes each
/// one down in the ledger. Calls `on_job` with each one and its id. Throws Error when
/// Slurm refuses one: those before it stay submitted, and what isn't can be submitted later. Throws
/// InputError as job_script(), Error when writing fails.
void submit_jobs(const Plan& plan, const std::vector<Job>& jobs,
                 const std::vector<std::string>& options,
                 const std::function<void(const Job&, const std::string&)>& on_job);

}  // namespace npdr::pipeline
