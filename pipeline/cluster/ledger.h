/// The ledger of a study's submissions, <work>/<study>/jobs/submitted.jsonl: a line a job. It is
/// for people and for finding logs; what is queued is asked from the batch system itself.
#pragma once

#include <filesystem>
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

}  // namespace npdr::pipeline
