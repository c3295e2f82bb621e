#include "pipeline/run/run_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <deque>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/printable.h"
#include "core/text.h"
#include "pipeline/plan/completeness.h"

namespace npdr::pipeline {
namespace {

const std::string kAnyMethod = "(any)";

// "01:24, 00:31 left"; "01:24" where what is left isn't known, or nothing.
std::string time_text(const RunProgress& run) {
  const bool is_known = run.seconds_left.value_or(0.0) > 0.0;
  return clock_text(run.seconds) + (is_known ? ", " + clock_text(*run.seconds_left) + " left" : "");
}

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

// Begins the last line of a log.
std::string failure_mark(const std::string& key) {
  return fmt::format("npdr: artefact {} failed: ", key);
}

}  // namespace

RunCosts::RunCosts(const Plan& plan) : plan_(plan) {
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::report || !is_complete(plan, node)) continue;
    if (means_.contains({node.stage, node.uses.front().method})) continue;
    try {
      learn(node, read_artefact_info(node.path).provenance.cost.core_seconds);
    } catch (const Error&) {
      // Damaged: whoever needs it says so.
    }
  }
}

double RunCosts::size_of(const Node& node) const {
  return node.stage == Stage::simulate ? static_cast<double>(num_rows(plan_, node)) : 1.0;
}

void RunCosts::learn(const Node& node, double core_seconds) {
  for (const std::string& method : {node.uses.front().method, kAnyMethod}) {
    Mean& mean = means_[{node.stage, method}];
    mean.sum += core_seconds;
    mean.count += size_of(node);
  }
}

std::optional<double> RunCosts::expected(const Node& node) const {
  for (const std::string& method : {node.uses.front().method, kAnyMethod}) {
    const auto known = means_.find({node.stage, method});
    if (known != means_.end()) return size_of(node) * known->second.sum / known->second.count;
  }
  return std::nullopt;
}

void WorkLeft::add(Stage stage, std::optional<double> core_seconds) {
  if (core_seconds) {
    known_ += *core_seconds;
    ++num_known_;
  } else {
    ++num_unknown_[stage];
  }
}

std::optional<double> WorkLeft::share_done(double done, Index num_made) const {
  const bool has_several =
      std::ranges::any_of(num_unknown_, [](const auto& s) { return s.second > 1; });
  const Index num_unknown = std::ssize(num_unknown_);
  // A report costs less than others do.
  const Index num_doubtful = num_unknown - (num_unknown_.contains(Stage::report) ? 1 : 0);
  if (has_several || num_doubtful > num_known_) return std::nullopt;
  const Index num_others = num_known_ + num_made;
  if (num_unknown > 0 && num_others == 0) return std::nullopt;
  const double each = num_others > 0 ? (known_ + done) / static_cast<double>(num_others) : 0.0;
  const double rest = known_ + static_cast<double>(num_unknown) * each;
  return done + rest > 0.0 ? done / (done + rest) : 0.0;
}

std::string silence_text(double seconds) {
  constexpr double usual = 60.0;
  return seconds < usual ? "" : ", nothing new for " + clock_text(seconds);
}

std::vector<std::string> live_lines(const RunProgress& run, const TerminalSize& size) {
  const int bar_width = size.columns < 60 ? 12 : 24;
  const std::string percent = run.share ? fmt::format("{:3.0f} % ", 100.0 * *run.share) : "";
  std::vector<std::string> lines = {fmt::format("{} {} {}{}, {} of {} artefacts", run.study,
                                                bar(run.share.value_or(0.0), bar_width), percent,
                                                time_text(run), run.num_made, run.num_missing)};
  constexpr std::size_t rows_of_others = 3;
  const auto rows = static_cast<std::size_t>(size.rows);
  if (run.jobs.size() + rows_of_others <= rows) {
    for (const std::string& job : run.jobs) lines.push_back("  " + job);
  } else if (!run.jobs.empty() && rows > rows_of_others) {
    lines.push_back(fmt::format("  {} jobs: {}", run.jobs.size(), run.jobs.front()));
  }
  return lines;
}

std::string log_line(const RunProgress& run) {
  const std::string percent = run.share ? fmt::format("{:.0f} %, ", 100.0 * *run.share) : "";
  std::string text = fmt::format("{}: {}{} of {} artefacts [{}]", run.study, percent, run.num_made,
                                 run.num_missing, time_text(run));
  for (const std::string& job : run.jobs) text += " | " + job;
  return text;
}

void log_failure(const std::filesystem::path& log, const std::string& key, int status,
                 const std::vector<std::string>& said) noexcept {
  const auto is_error = [](const std::string& line) {
    return !line.starts_with("warning: ") && !line.starts_with("note: ");
  };
  try {
    const auto cause = std::ranges::find_if(said, is_error);
    std::ofstream(log, std::ios::app)
        << "\n"
        << failure_mark(key) << how_it_ended(status)
        << (cause == said.end() ? "" : ": " + printable_line(*cause)) << "\n";
  } catch (const std::exception&) {
    // The run itself says so, too.
  }
}

std::optional<std::string> failure_in(const std::filesystem::path& log, const std::string& key) {
  const std::string mark = failure_mark(key);
  std::ifstream file(log);
  std::optional<std::string> failure;
  for (std::string line; std::getline(file, line);) {
    failure = line.starts_with(mark) ? std::optional(line.substr(mark.size())) : std::nullopt;
  }
  return failure;
}

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
