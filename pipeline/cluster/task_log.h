/// The lines that a batch task writes into its log, and their reading back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// "npdr task: 17_3 on n2, 2024-03-01T12:00:00Z: npdr-simulate ...".
std::string begin_line(const std::string& id, const std::vector<std::string>& command);

/// "npdr task: exit status 1 after 12.3 s".
std::string end_line(int exit_status, double seconds);

/// Why the task that wrote `log` ended: its exit status, and what it said last; empty: it didn't
/// come to its end.
std::string reason_in_log(const std::filesystem::path& log);

}  // namespace npdr::pipeline
