/// Other programs, run without a shell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace npdr::analysis {

struct ProcessResult {
  bool found = false;      ///< false: there is no such program
  bool timed_out = false;  ///< it was ended after its time limit
  int exit_status = 0;     ///< 128 + signal number when a signal ended it
  std::string errors;      ///< what it wrote to standard error
};

struct ProcessOptions {
  double time_limit = 300.0;            ///< [s]
  std::vector<std::string> unset = {};  ///< variables of this process that it doesn't get
  std::vector<std::string> set = {};    ///< "NAME=value" that it gets besides
};

/// Runs `program` (looked up on PATH when it holds no slash) with `arguments`, which reach it
/// unchanged whatever characters they hold, in `directory`, and waits for its end. Its standard
/// input is empty and its standard output is dropped. It ends with the thread that calls this.
/// Throws Error when it can't be started for another reason than that it is missing.
ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& directory,
                          const ProcessOptions& options = {});

}  // namespace npdr::analysis
