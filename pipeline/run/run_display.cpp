#include "pipeline/run/run_display.h"

#include <fmt/format.h>

#include "core/text.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

std::string counts(const RunProgress& run) {
  return fmt::format("{} of {} artefacts", run.num_made, run.num_missing);
}

}  // namespace

std::string time_text(const RunProgress& run) {
  const std::string passed = clock_text(run.seconds);
  if (run.share <= 0.0 || run.share >= 1.0) return passed;
  return passed + ", " + clock_text(run.seconds * (1.0 - run.share) / run.share) + " left";
}

std::vector<std::string> live_lines(const RunProgress& run, const TerminalSize& size) {
  const int bar_width = size.columns < 60 ? 12 : 24;
  std::vector<std::string> lines = {fmt::format("{} {} {:3.0f} % {}, {}", run.study,
                                                bar(run.share, bar_width), 100.0 * run.share,
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
  std::string text = fmt::format("{}: {:.0f} %, {} [{}]", run.study, 100.0 * run.share, counts(run),
                                 time_text(run));
  for (const std::string& job : run.jobs) text += " | " + job;
  return text;
}

}  // namespace npdr::pipeline
