#include "pipeline/process/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "core/printable.h"

namespace npdr::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

int parent_descriptor() {
  const char* text = std::getenv("NPDR_PROGRESS_FD");
  return text == nullptr ? -1 : std::atoi(text);
}

}  // namespace

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(seconds);
  if (whole >= 3600) {
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  }
  return fmt::format("{:02}:{:02}", whole / 60, whole % 60);
}

std::string progress_text(Index done, Index total, double seconds, Index begun) {
  const double rate = seconds > 0.0 ? static_cast<double>(done - begun) / seconds : 0.0;
  if (total == 0) return fmt::format("{} [{}, {:.3g}/s]", done, clock_text(seconds), rate);
  const double left = rate > 0.0 ? static_cast<double>(total - done) / rate : 0.0;
  return fmt::format("{}/{} [{}<{}, {:.3g}/s]", done, total, clock_text(seconds),
                     done > begun ? clock_text(left) : "?", rate);
}

void report_note(const std::string& note) noexcept {
  const int parent = parent_descriptor();
  if (parent < 0) return;
  const std::string line = "?" + printable_line(note) + "\n";
  [[maybe_unused]] const auto written = write(parent, line.data(), line.size());
}

void report_error(const std::string& program, const std::string& message) noexcept {
  const std::string shown = printable(message);
  std::fflush(stdout);  // whose lines stay whole where both are one file
  std::fputs((program + ": " + shown + "\n").c_str(), stderr);
  const int parent = parent_descriptor();
  if (parent < 0) return;
  std::istringstream lines(shown);
  for (std::string line; std::getline(lines, line);) {
    line = "!" + line + "\n";
    [[maybe_unused]] const auto written = write(parent, line.data(), line.size());
  }
}

void report_findings(const std::string& program, const Findings& findings) {
  for (const Finding& finding : findings) report_error(program, text_of(finding));
}

void report_warning(const std::string& program, std::string what) {
  report_findings(program, {warning(std::move(what))});
}

Progress::Progress(std::string label, Index total, Index begun)
    : label_(std::move(label)),
      total_(total),
      begun_(begun),
      parent_(parent_descriptor()),
      start_(Clock::now()),
      shown_(start_) {
  if (parent_ >= 0) show(begun_, "");
}

void Progress::update(Index done, const std::string& note) {
  const auto now = Clock::now();
  const bool is_last = total_ > 0 && done >= total_;
  const bool is_watched = parent_ >= 0 || line_.is_terminal();
  if (seconds_between(shown_, now) < (is_watched ? 0.1 : 60.0) && !(is_last && is_watched)) return;
  shown_ = now;
  show(done, note);
}

void Progress::show(Index done, const std::string& note) {
  if (parent_ >= 0) {
    const std::string line = fmt::format("{} {} {}\n", done, total_, note);
    [[maybe_unused]] const auto written = write(parent_, line.data(), line.size());
    return;
  }
  const std::string text = label_ + ": " +
                           progress_text(done, total_, seconds_between(start_, shown_), begun_) +
                           (note.empty() ? "" : ", " + note);
  line_.show({text});
  if (!line_.is_terminal()) std::fputs((text + "\n").c_str(), stderr);
}

}  // namespace npdr::pipeline
