#include "pipeline/process/batch_job.h"

#include <fcntl.h>

#include <cstdlib>

#include "core/open_file.h"

namespace npdr::pipeline {
namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::string batch_job_id() {
  if (const std::string id = variable("NPDR_JOB_ID"); !id.empty()) return id;
  if (const std::string id = slurm_task_id(); !id.empty()) return id;
  for (const char* name : {"PBS_JOBID", "LSB_JOBID", "JOB_ID"}) {
    if (const std::string id = variable(name); !id.empty()) return id;
  }
  return "";
}

std::string slurm_task_id() {
  const std::string array = variable("SLURM_ARRAY_JOB_ID");
  if (!array.empty()) return array + "_" + variable("SLURM_ARRAY_TASK_ID");
  return variable("SLURM_JOB_ID");
}

void mark_progress() noexcept {
  const char* const path = std::getenv(kTaskMark);
  if (path == nullptr) return;
  constexpr unsigned only_ours = 0600;
  const OpenFile mark(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, only_ours);
}

}  // namespace npdr::pipeline
