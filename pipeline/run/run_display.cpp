#include "pipeline/run/run_display.h"

#include <fmt/format.h>

#include "core/text.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

std::string counts(const RunProgress& run) {
  return fmt::format("{} of {} artefacts", run.num_made, run.num_missing);
}

// "01:24, 00:31 left"; "01:24" where what is left isn't known, or nothing.
std::string time_text(const RunProgress& run) {
  const std::string passed = clock_text(run.seconds);
  if (run.seconds_left.value_or(0.0) <= 0.0) return passed;
  return passed + ", " + clock_text(*run.seconds_left) + " left";
}

}  // namespace

std::string silence_text(double seconds) {
  constexpr double usual = 60.0;
  return seconds < usual ? "" : ", nothing new for " + clock_text(seconds);
}

std::vector<std::string> live_lines(const RunProgress& run, const TerminalSize& size) {
  const int bar_width = size.columns < 60 ? 12 : 24;
  const std::string percent = run.share ? fmt::format("{:3.0f} % ", 100.0 * *run.share) : "";
  std::vector<std::string> lines = {fmt::format("{} {} {}{}, {}", run.study,
                                                bar(run.share.value_or(0.0), bar_width), percent,
                                                time_text(run), counts(run))};
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
  std::string text = fmt::format("{}: {}{} [{}]", run.study, percent, counts(run), time_text(run));
  for (const std::string& job : run.jobs) text += " | " + job;
  return text;
}

}  // namespace npdr::pipeline
