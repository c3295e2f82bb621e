#include "pipeline/cluster/task_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>

#include "core/atomic_file.h"
#include "core/shell_text.h"
#include "pipeline/process/utc_time.h"

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

// Finds the message that a program ends with: "program: message". 'npdr run' quotes it from a
// stage, indented below "... failed (exit status 1):".
std::string message_in(const std::vector<std::string>& lines) {
  const auto is_headline = [](const std::string& line) {
    return line.find(" failed (") != std::string::npos && line.ends_with("):");
  };
  const auto headline = std::find_if(lines.rbegin(), lines.rend(), is_headline);
  if (headline != lines.rend() && headline != lines.rbegin()) {
    const std::string& quoted = *std::prev(headline);
    return quoted.substr(std::min(quoted.find_first_not_of(' '), quoted.size()));
  }
  return lines.empty() || lines.back().starts_with(kMark) ? "" : lines.back();
}

}  // namespace

std::string begin_line(const std::string& id, const std::vector<std::string>& command) {
  return fmt::format("{}{} on {}, {}: {}", kMark, id.empty() ? "no batch job" : id, host_name(),
                     now_utc(), shell_text(command));
}

std::string end_line(int exit_status, double seconds) {
  return fmt::format("{}{}{} after {:.1f} s", kMark, kEnd, exit_status, seconds);
}

std::optional<TaskEnd> end_in_log(const std::filesystem::path& log) {
  const std::vector<std::string> lines = last_lines(log);
  const std::string begin = std::string(kMark) + std::string(kEnd);
  if (lines.empty() || !lines.back().starts_with(begin)) return std::nullopt;
  const std::string& last = lines.back();
  TaskEnd end{0, last.substr(kMark.size())};
  const char* const number = last.data() + begin.size();
  if (std::from_chars(number, last.data() + last.size(), end.exit_status).ptr == number) {
    return std::nullopt;
  }
  const std::string message = message_in({lines.begin(), lines.end() - 1});
  if (!message.empty()) end.words += ": " + message;
  return end;
}

}  // namespace npdr::pipeline
