/// What `npdr run` shows of its progress.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/process/live_lines.h"

namespace npdr::pipeline {

/// A run as it stands.
struct RunProgress {
  std::string study;
  std::size_t num_made = 0;
  std::size_t num_missing = 0;       ///< when it began
  double seconds = 0.0;              ///< since then
  std::optional<double> share = {};  ///< of the work that is done, by its cost; none: unknown
  std::optional<double> seconds_left = {};  ///< as long as what is done took, by its cost
  std::vector<std::string> jobs = {};  ///< "infer NPE, seed 1, round 1: 120 epochs, loss 1.2", ...
};

/// ", nothing new for 02:15", of a job that may hang; "" before a minute is over.
std::string silence_text(double seconds);

/// Lines for a terminal: a bar, and below it a line for each job where there is room.
std::vector<std::string> live_lines(const RunProgress& run, const TerminalSize& size);

/// One line for a log.
std::string log_line(const RunProgress& run);

}  // namespace npdr::pipeline
