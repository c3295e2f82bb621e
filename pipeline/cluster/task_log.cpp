#include "pipeline/cluster/task_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "core/atomic_file.h"
#include "pipeline/external/command_text.h"
#include "pipeline/store/utc_time.h"

namespace npdr::pipeline {
namespace {

constexpr std::string_view kMark = "npdr task: ";
constexpr std::string_view kEnd = "exit status ";

// The last lines of a file that may be long.
std::vector<std::string> last_lines(const std::filesystem::path& path) {
  constexpr std::streamoff most = 8192;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  if (size <= 0) return {};
  file.seekg(std::max<std::streamoff>(0, size - most));
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

}  // namespace

std::string begin_line(const std::string& id, const std::vector<std::string>& command) {
  return fmt::format("{}{} on {}, {}: {}", kMark, id.empty() ? "no batch job" : id, host_name(),
                     now_utc(), shell_text(command));
}

std::string end_line(int exit_status, double seconds) {
  return fmt::format("{}{}{} after {:.1f} s", kMark, kEnd, exit_status, seconds);
}

std::string reason_in_log(const std::filesystem::path& log) {
  const std::vector<std::string> lines = last_lines(log);
  if (lines.empty()) return "";
  const std::string& last = lines.back();
  if (!last.starts_with(std::string(kMark) + std::string(kEnd))) return "";
  std::string reason = last.substr(kMark.size());
  // What a program says at its end is "program: message".
  const bool has_message = lines.size() > 1 && !lines[lines.size() - 2].starts_with(kMark);
  if (has_message) reason += ": " + lines[lines.size() - 2];
  return reason;
}

}  // namespace npdr::pipeline
