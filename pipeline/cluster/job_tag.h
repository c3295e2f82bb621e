/// Tag of a job: its comment, by which Slurm's queue tells what is being made, and what waits for
/// what will never come.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/cluster/job.h"
#include "pipeline/cluster/slurm.h"

namespace npdr::pipeline {

/// "npdr:<work folder>:<keys>:<shards per task>:<first task>"; of helpers it begins with
/// "npdr-help".
struct JobTag {
  std::string work;               ///< digits that tell work folders apart
  std::vector<std::string> keys;  ///< first digits of what the job makes
  Index shards_per_task = 0;
  Index first_task = 0;
  bool is_helper = false;  ///< makes nothing of the keys, but helps those that do

  std::string text() const;
};

JobTag tag_of(const Plan& plan, const Job& job);

/// Reads a comment; none: the job isn't one of ours.
std::optional<JobTag> parse_tag(const std::string& comment);

/// For each node of the plan, what of `tasks` makes it, or helps to.
std::vector<InFlight> in_flight(const Plan& plan, const std::vector<QueuedTask>& tasks);

/// The tasks among `tasks` that make anything of this plan, or help to.
std::vector<QueuedTask> tasks_of(const Plan& plan, const std::vector<QueuedTask>& tasks);

/// The ids of the study's jobs among `tasks` that haven't begun and need an artefact that is
/// neither there nor being made: a task of the array that they wait for has failed while others of
/// it still run. Slurm would end them later; whoever submits again has to make them anew.
std::vector<std::string> doomed_jobs(const Plan& plan, const std::vector<QueuedTask>& tasks);

/// `tasks` without those of `jobs`.
std::vector<QueuedTask> without_jobs(const std::vector<QueuedTask>& tasks,
                                     const std::vector<std::string>& jobs);

}  // namespace npdr::pipeline
