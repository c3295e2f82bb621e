/// The lines that a batch task writes into its log, and their reading back.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// "npdr task: 17_3 on n2, 2024-03-01T12:00:00Z: npdr-simulate ...".
std::string begin_line(const std::string& id, const std::vector<std::string>& command);

/// "npdr task: exit status 1 after 12.3 s".
std::string end_line(int exit_status, double seconds);

/// How a task ended.
struct TaskEnd {
  int exit_status = 0;
  std::string words;  ///< "exit status 1 after 12.3 s: npdr-simulate: the disk is full"
};

/// The end of the task that wrote `log`; none: it didn't come to its end.
std::optional<TaskEnd> end_in_log(const std::filesystem::path& log);

}  // namespace npdr::pipeline
