/// What `npdr run` says of jobs that failed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// The file that a job's standard error went to, after what earlier jobs left in it.
struct JobLog {
  std::filesystem::path path;
  std::uintmax_t begin = 0;  ///< where what the job wrote begins
};

/// Tells each cause once: a simulator that can't be used lets every job fail that asks it.
class FailureWords {
 public:
  /// Lines about a job that ended with `status` (128 + a signal). `said`: its own words; where
  /// there are none, the end of its log does. Lines that were told of another job, with whatever
  /// numbers, aren't repeated.
  std::string tell(const std::string& label, int status, const std::vector<std::string>& said,
                   const JobLog& log);

 private:
  std::set<std::string> told_;
};

}  // namespace npdr::pipeline
