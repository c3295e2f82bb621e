#include "pipeline/store/batch_job.h"

#include <cstdlib>

namespace npdr::pipeline {
namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::string batch_job_id() {
  if (const std::string array = variable("SLURM_ARRAY_JOB_ID");
      !array.empty() && variable("NPDR_JOB_ID").empty()) {
    return array + "_" + variable("SLURM_ARRAY_TASK_ID");
  }
  for (const char* name : {"NPDR_JOB_ID", "SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID", "JOB_ID"}) {
    if (const std::string id = variable(name); !id.empty()) return id;
  }
  return "";
}

}  // namespace npdr::pipeline
