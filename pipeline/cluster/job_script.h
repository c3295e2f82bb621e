/// Job scripts: what a person could have written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/cluster/job.h"

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

/// The log of a task.
std::filesystem::path log_of_task(const std::filesystem::path& logs, const std::string& stem,
                                  const std::string& id);

/// The resources of a stage: its own, else those of the whole [cluster].
StageResources resources_of(const ClusterConfig& cluster, Stage stage);

}  // namespace npdr::pipeline
