/// Jobs that wait for what will never come.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cluster/slurm.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// The ids of the study's jobs among `tasks` that haven't begun and need an artefact that is
/// neither there nor being made: a task of the array that they wait for has failed while others of
/// it still run. Slurm would end them later; whoever submits again has to make them anew.
std::vector<std::string> doomed_jobs(const Plan& plan, const std::vector<QueuedTask>& tasks);

/// `tasks` without those of `jobs`.
std::vector<QueuedTask> without_jobs(const std::vector<QueuedTask>& tasks,
                                     const std::vector<std::string>& jobs);

}  // namespace npdr::pipeline
