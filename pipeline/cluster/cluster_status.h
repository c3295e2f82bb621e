/// How a batch system stands with a study: for each artefact, what waits, runs, or has failed; and
/// the ledger of submissions, <work>/<study>/jobs/submitted.jsonl, a line a job. It is for people
/// and for finding logs; what is queued is asked from the batch system itself.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/open_file.h"
#include "pipeline/cluster/job_tag.h"

namespace npdr::pipeline {

struct LedgerEntry {
  std::string job;           ///< id
  JobTag tag;                ///< what it makes
  std::vector<Index> tasks;  ///< of an array
  std::filesystem::path script;
  std::filesystem::path logs;  ///< folder
  std::string stem;            ///< of the logs' names
  std::string submitted;       ///< UTC
};

/// Where scripts, logs and the ledger of a study lie.
std::filesystem::path jobs_folder(const Plan& plan);

/// Holds the lock of jobs_folder() as long as it lives, or as its process does. Waits for another
/// holder for a minute, then throws Error. A file system without locks has none to give.
class SubmissionLock {
 public:
  explicit SubmissionLock(const Plan& plan);

 private:
  OpenFile file_;
};

/// Appends a line, at once on the disk. Throws Error.
void append_to_ledger(const Plan& plan, const LedgerEntry& entry);

/// The entries, oldest first; none where there is no ledger. A line that can't be read, such as one
/// that was being written when the power went, is left out.
std::vector<LedgerEntry> read_ledger(const Plan& plan);

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
