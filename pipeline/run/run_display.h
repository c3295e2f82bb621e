/// What `npdr run` shows of its progress.
#pragma once

#include <string>
#include <vector>

#include "pipeline/process/live_lines.h"

namespace npdr::pipeline {

/// A run as it stands.
struct RunProgress {
  std::string study;
  std::size_t num_made = 0;
  std::size_t num_missing = 0;    ///< when it began
  double seconds = 0.0;           ///< since then
  double share = 0.0;             ///< of the work that is done, by what it costs
  std::vector<std::string> jobs;  ///< that run: "infer NPE, seed 1, round 1: 120 epochs, loss 1.2"
};

/// "01:24, 00:31 left": the rest takes as long as what is done, by its cost; "01:24" before and
/// after that is known.
std::string time_text(const RunProgress& run);

/// Lines for a terminal: a bar, and below it a line for each job where there is room.
std::vector<std::string> live_lines(const RunProgress& run, const TerminalSize& size);

/// One line for a log.
std::string log_line(const RunProgress& run);

}  // namespace npdr::pipeline
