/// Progress of long work: a live line on a terminal, a plain line a minute elsewhere.
#pragma once

#include <chrono>
#include <string>

#include "core/finding.h"
#include "core/types.h"
#include "pipeline/process/live_lines.h"

namespace npdr::pipeline {

/// "simulate NPDR (MAF), seed 1, round 2: 400/1000 [00:03<00:05, 120/s]" on stderr. Where a parent
/// process shows the progress of many (environment variable NPDR_PROGRESS_FD), the counts go there
/// instead. Not thread-safe.
class Progress {
 public:
  /// total = 0: not known beforehand (training that stops by itself). `begun`: what was done
  /// before; it says nothing of how long the rest takes.
  Progress(std::string label, Index total, Index begun = 0);

  void update(Index done, const std::string& note = "");

 private:
  void show(Index done, const std::string& note);

  std::string label_;
  Index total_;
  Index begun_;
  int parent_;  ///< file descriptor, -1: none
  LiveLines line_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point shown_;
};

/// Shows `note` beside the counts of a parent process's display until the next update: what goes
/// wrong on the way of work that goes on. One line, whatever it holds. Thread-safe; never throws.
void report_note(const std::string& note) noexcept;

/// "program: message" on stderr, and to a parent process that shows progress: where the disk is
/// full, the log that stderr goes to stays empty. Never throws.
void report_error(const std::string& program, const std::string& message) noexcept;

/// The same of each finding, as text_of().
void report_findings(const std::string& program, const Findings& findings);
void report_warning(const std::string& program, std::string what);

/// "400/1000 [00:03<00:05, 120/s]"; without a total "400 [00:03, 120/s]". `begun` of `done` weren't
/// done in these seconds.
std::string progress_text(Index done, Index total, double seconds, Index begun = 0);

/// "03:25", "1:02:03".
std::string clock_text(double seconds);

}  // namespace npdr::pipeline
