#include "pipeline/run/failure_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <deque>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/printable.h"

namespace npdr::pipeline {
namespace {

std::string tail_of(const JobLog& log) {
  constexpr std::size_t num_lines = 20;
  std::ifstream file(log.path);
  file.seekg(static_cast<std::streamoff>(log.begin));
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back("    " + printable_line(line) + "\n");
    if (lines.size() > num_lines) lines.pop_front();
  }
  return fmt::format("{}", fmt::join(lines, ""));
}

// Counts of rows and seconds differ from job to job; what is part of a name or path does not.
std::string without_numbers(const std::string& text) {
  std::istringstream words(text);
  std::string result;
  for (std::string word; words >> word;) {
    if (word.find_first_not_of("0123456789.,:;()") != std::string::npos) result += word;
    result += ' ';
  }
  return result;
}

std::string how_it_ended(int status) {
  if (status <= 128) return fmt::format("exit status {}", status);
  const int signal = status - 128;
  constexpr int crashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  const char* what_now = "";
  if (signal == SIGKILL) {
    what_now = ", often for want of memory; run it again, with a smaller --jobs if that recurs";
  } else if (std::ranges::count(crashes, signal) > 0) {
    what_now = ", it crashed, maybe in a simulator.library; a worker that crashes costs only rows";
  }
  return fmt::format("killed by signal {}{}", signal, what_now);
}

}  // namespace

std::string FailureWords::tell(const std::string& label, int status,
                               const std::vector<std::string>& said, const JobLog& log) {
  const std::string how = how_it_ended(status);
  std::string lines = said.empty() ? tail_of(log) : "";
  std::set<std::string> new_lines;
  const bool repeats = !said.empty() && told_.contains(without_numbers(said.front()));
  for (const std::string& line : said) {
    const std::string words = without_numbers(line);
    if (told_.contains(words)) continue;
    new_lines.insert(words);
    lines += "    " + line + "\n";
  }
  told_.merge(new_lines);
  const bool is_stopped = status == static_cast<int>(ExitStatus::checkpointed);
  return fmt::format("npdr: {} {} ({}){}:\n{}    log: {}\n", label,
                     is_stopped ? "stopped" : "failed", how, repeats ? ", as above" : "", lines,
                     log.path.string());
}

}  // namespace npdr::pipeline
