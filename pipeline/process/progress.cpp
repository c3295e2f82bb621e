#include "pipeline/process/progress.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "core/open_file.h"
#include "core/printable.h"

namespace npdr::pipeline {
namespace {

int parent_descriptor() {
  const char* text = std::getenv("NPDR_PROGRESS_FD");
  return text == nullptr ? -1 : std::atoi(text);
}

void tell_parent(const std::string& line) {
  [[maybe_unused]] const auto written = write(parent_descriptor(), line.data(), line.size());
}

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::string bar(double share, int width) {
  const auto inside = static_cast<std::size_t>(std::max(0, width - 2));
  const auto full = static_cast<std::size_t>(
      std::floor(std::clamp(share, 0.0, 1.0) * static_cast<double>(inside)));
  return "[" + std::string(full, '#') + std::string(inside - full, '.') + "]";
}

LiveLines::~LiveLines() {
  if (num_shown_ > 0) std::fputc('\n', stderr);
}

std::string LiveLines::back_to_the_first() const {
  std::string text = num_shown_ > 0 ? "\r" : "";
  for (std::size_t line = 1; line < num_shown_; ++line) text += "\033[A";
  return text;
}

void LiveLines::show(const std::vector<std::string>& lines) {
  if (!is_terminal_) return;
  const int columns = size().columns - 1;  // the last one may wrap already
  std::string text = back_to_the_first();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += (i > 0 ? "\n" : "") + fitted(lines[i], columns) + "\033[K";
  }
  num_shown_ = lines.size();
  std::fputs((text + "\033[J").c_str(), stderr);
  std::fflush(stderr);
}

void LiveLines::clear() {
  if (num_shown_ == 0) return;
  std::fputs((back_to_the_first() + "\033[J").c_str(), stderr);
  num_shown_ = 0;
}

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
  if (parent_descriptor() >= 0) tell_parent("?" + printable_line(note) + "\n");
}

void report_error(const std::string& program, const std::string& message) noexcept {
  const std::string shown = printable(message);
  std::fflush(stdout);  // whose lines stay whole where both are one file
  std::fputs((program + ": " + shown + "\n").c_str(), stderr);
  if (parent_descriptor() < 0) return;
  std::istringstream lines(shown);
  for (std::string line; std::getline(lines, line);) tell_parent("!" + line + "\n");
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
      has_parent_(parent_descriptor() >= 0) {
  if (has_parent_) show(begun_, "");
}

void Progress::update(Index done, const std::string& note) {
  const bool is_last = total_ > 0 && done >= total_;
  const bool is_watched = has_parent_ || line_.is_terminal();
  if (seconds_since(shown_) < (is_watched ? 0.1 : 60.0) && !(is_last && is_watched)) return;
  shown_ = Clock::now();
  show(done, note);
}

void Progress::show(Index done, const std::string& note) {
  if (has_parent_) return tell_parent(fmt::format("{} {} {}\n", done, total_, note));
  const std::string text = label_ + ": " +
                           progress_text(done, total_, seconds_since(start_), begun_) +
                           (note.empty() ? "" : ", " + note);
  line_.show({text});
  if (!line_.is_terminal()) std::fputs((text + "\n").c_str(), stderr);
}

std::string batch_job_id() {
  if (const std::string id = variable("NPDR_JOB_ID"); !id.empty()) return id;
  if (const std::string id = slurm_task_id(); !id.empty()) return id;
  for (const char* name : {"PBS_JOBID", "LSB_JOBID", "JOB_ID"}) {
    if (const std::string id = variable(name); !id.empty()) return id;
  }
  return "";
}

std::string slurm_task_id() {
  const std::string array = variable("SLURM_ARRAY_JOB_ID");
  if (!array.empty()) return array + "_" + variable("SLURM_ARRAY_TASK_ID");
  return variable("SLURM_JOB_ID");
}

void mark_progress() noexcept {
  const char* const path = std::getenv(kTaskMark);
  if (path == nullptr) return;
  constexpr unsigned only_ours = 0600;
  const OpenFile mark(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, only_ours);
}

}  // namespace npdr::pipeline
