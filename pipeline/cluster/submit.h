/// Job scripts, as a person could have written them, and their submission to Slurm.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/cluster/job.h"
#include "pipeline/cluster/slurm.h"

namespace npdr::pipeline {

/// Context that all scripts of one submission share.
struct ScriptContext {
  const Plan& plan;
  std::filesystem::path folder;    ///< where the programs run: the current one
  std::filesystem::path programs;  ///< where they are
  std::filesystem::path logs;      ///< absolute
};

/// A script for sbatch: resources of the job's stage, then one command. The array's indices and
/// dependencies, which belong to one submission, are options of sbatch instead. Throws InputError
/// for folders that Slurm can't be given.
std::string job_script(const ScriptContext& context, const Job& job);

/// A name for the files of a job: "simulate-npdr-maf-seed-1-round-1".
std::string file_stem_of(const Plan& plan, const Job& job);

/// The resources of a stage: its own, else those of the whole [cluster].
StageResources resources_of(const ClusterConfig& cluster, Stage stage);

/// The jobs that are missing, given what Slurm has of the study already. Throws InputError for a
/// damaged shard, Error when a truth can't be simulated.
std::vector<Job> missing_jobs(const Plan& plan, std::optional<Stage> until,
                              const std::vector<QueuedTask>& queued, Index max_array_size);

/// Scripts of all jobs, and the commands that would submit them, in which JOB_1 stands for the id
/// of the first one. `options`: further words for sbatch. Throws InputError as job_script().
std::string dry_run_text(const Plan& plan, const std::vector<Job>& jobs,
                         const std::vector<std::string>& options);

/// Writes the scripts to a new folder of <work>/<study>/jobs, submits them in order and notes each
/// one down in the ledger. Calls `on_job` with each one and its id. Throws Error when Slurm refuses
/// one: those before it stay submitted, and what isn't can be submitted later. Throws InputError as
/// job_script(), Error when writing fails.
void submit_jobs(const Plan& plan, const std::vector<Job>& jobs,
                 const std::vector<std::string>& options,
                 const std::function<void(const Job&, const std::string&)>& on_job);

}  // namespace npdr::pipeline
