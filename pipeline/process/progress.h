/// Progress of long work: live lines on a terminal, a plain line a minute elsewhere; and the batch
/// job that a process is a part of, whose task learns whether what it ran has brought anything to
/// the disk.
#pragma once

#include <unistd.h>

#include <chrono>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/types.h"
#include "pipeline/process/fitted_text.h"

namespace npdr::pipeline {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// "[#####.....]" of `width` characters; share in [0, 1].
std::string bar(double share, int width);

/// Lines at the end of stderr's terminal that are written anew in their place. None is ever wider
/// than the terminal: one that wrapped couldn't be taken back. Never throws: a terminal that was
/// closed ends no run. Not thread-safe.
class LiveLines {
 public:
  LiveLines() : is_terminal_(isatty(STDERR_FILENO) != 0) {}
  /// Ends the last line.
  ~LiveLines();
  LiveLines(const LiveLines&) = delete;
  LiveLines& operator=(const LiveLines&) = delete;

  /// Whether stderr is a terminal; elsewhere nothing can be taken back, and show() does nothing.
  bool is_terminal() const { return is_terminal_; }
  /// As it is now: people change it.
  TerminalSize size() const { return terminal_size(STDERR_FILENO).value_or(TerminalSize{}); }

  /// Writes these in place of those that are shown.
  void show(const std::vector<std::string>& lines);
  /// Takes them back: what is printed next stands in their place.
  void clear();

 private:
  std::string back_to_the_first() const;

  bool is_terminal_;
  std::size_t num_shown_ = 0;
};

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
  bool has_parent_;  ///< a process that shows the progress
  LiveLines line_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point shown_ = start_;
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

/// The id of the task, as Slurm ("17", "17_3" in an array), PBS, LSF or Grid Engine give it to a
/// job's environment; NPDR_JOB_ID comes before them all. Empty: none.
std::string batch_job_id();

/// The same of Slurm alone.
std::string slurm_task_id();

/// The variable that names the mark's file to the programs of a task.
inline constexpr const char* kTaskMark = "NPDR_TASK_MARK";

/// Makes the mark, if this process is a part of a task: an artefact, shard or checkpoint is there
/// now. Never throws.
void mark_progress() noexcept;

}  // namespace npdr::pipeline
