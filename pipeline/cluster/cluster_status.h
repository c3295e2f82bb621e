/// How a batch system stands with a study: for each artefact, what waits, runs, or has failed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/cluster/ledger.h"

namespace npdr::pipeline {

struct NodeJobs {
  std::vector<QueuedTask> waiting;
  std::vector<QueuedTask> running;
  std::vector<std::string> failed;  ///< "job 17_3: exit status 1; log: ...", one a task
  Index num_helpers = 0;            ///< that run beside them
  /// The same of helpers, without which an artefact is made all the same.
  std::vector<std::string> failed_helpers;

  /// "2 running (17_3 on n1, ...), 5 queued (18, ...: Resources), 4 helpers"; the first of those
  /// that failed, and how many more did.
  std::vector<std::string> details() const;
};

/// For each node of the plan; none: no job has to do with it, or it is complete. `tasks`: those
/// that Slurm has; without an answer of it nothing counts as failed. Throws as ended_state().
std::vector<std::optional<NodeJobs>> jobs_of_nodes(
    const Plan& plan, const std::optional<std::vector<QueuedTask>>& tasks);

}  // namespace npdr::pipeline
