#include "pipeline/run/failure_words.h"

#include <fmt/format.h>

#include <deque>
#include <fstream>

namespace npdr::pipeline {
namespace {

std::string tail_of(const std::filesystem::path& path) {
  constexpr std::size_t num_lines = 10;
  std::ifstream file(path);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back("    " + line + "\n");
    if (lines.size() > num_lines) lines.pop_front();
  }
  return fmt::format("{}", fmt::join(lines, ""));
}

// Counts of rows and seconds differ from job to job.
std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  return text;
}

}  // namespace

std::string FailureWords::tell(const std::string& label, int status,
                               const std::vector<std::string>& said,
                               const std::filesystem::path& log) {
  const std::string how = status > 128 ? fmt::format("killed by signal {}", status - 128)
                                       : fmt::format("exit status {}", status);
  std::string lines = said.empty() ? tail_of(log) : "";
  std::set<std::string> new_lines;
  bool repeats = false;
  for (const std::string& line : said) {
    const std::string words = without_numbers(line);
    if (told_.contains(words)) {
      repeats = true;
      continue;
    }
    new_lines.insert(words);
    lines += "    " + line + "\n";
  }
  told_.merge(new_lines);
  return fmt::format("npdr: {} failed ({}){}:\n{}    log: {}\n", label, how,
                     repeats ? ", as above" : "", lines, log.string());
}

}  // namespace npdr::pipeline
