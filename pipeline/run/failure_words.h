/// What `npdr run` says of jobs that failed.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// Tells each cause once: a simulator that can't be used lets every job fail that asks it.
class FailureWords {
 public:
  /// Lines about a job that ended with `status` (128 + a signal). `said`: its own words; where
  /// there are none, the end of its log speaks. Lines that were told of another job, with whatever
  /// numbers, aren't repeated.
  std::string tell(const std::string& label, int status, const std::vector<std::string>& said,
                   const std::filesystem::path& log);

 private:
  std::set<std::string> told_;
};

}  // namespace npdr::pipeline
