/// How far a run has come, how long it still takes, and how `npdr run` shows that and failures.
/// Artefacts count by what they cost: a simulation of ten thousand rows and a proposal not as one
/// another.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/plan/plan.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {

/// Costs by stage and method. Simulations cost by the row.
class RunCosts {
 public:
  /// Learns from artefacts that are there: one of each stage and method.
  explicit RunCosts(const Plan& plan);

  void learn(const Node& node, double core_seconds);

  /// Core-seconds that `node` will probably cost: as others of its stage and method, or of its
  /// stage; none where there are none.
  std::optional<double> expected(const Node& node) const;

 private:
  struct Mean {
    double sum = 0.0;
    double count = 0.0;
  };
  double size_of(const Node& node) const;

  const Plan& plan_;
  std::map<std::pair<Stage, std::string>, Mean> means_;  // by method, and of all of them
};

/// What is left of a run, artefact by artefact.
class WorkLeft {
 public:
  /// `core_seconds`: what it still costs; none: unknown.
  void add(Stage stage, std::optional<double> core_seconds);

  /// Share of the run's work that is done: `num_made` artefacts, `done` core-seconds. What nothing
  /// tells the cost of is taken to cost as much as others do on average, if it is one of its stage
  /// and, but for the report, no more of these are left than others; none otherwise.
  std::optional<double> share_done(double done, Index num_made) const;

 private:
  double known_ = 0.0;  // core-seconds
  Index num_known_ = 0;
  std::map<Stage, Index> num_unknown_;
};

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

/// The file that a job's standard error went to, after what earlier jobs left in it.
struct JobLog {
  std::filesystem::path path;
  std::uintmax_t begin = 0;  ///< where what the job wrote begins
};

/// Ends the log of a job that failed with `status`: key of the artefact, how the job ended, and the
/// first of its own words `said` that are no warning. Never throws.
void log_failure(const std::filesystem::path& log, const std::string& key, int status,
                 const std::vector<std::string>& said) noexcept;

/// "exit status 1: no memory", where such a failure of the artefact `key` is the last that its log
/// tells.
std::optional<std::string> failure_in(const std::filesystem::path& log, const std::string& key);

/// Tells each cause once: a simulator that can't be used lets every job fail that asks it.
class FailureWords {
 public:
  /// Lines about a job that ended with `status` (128 + a signal). `said`: its own words; where
  /// there are none, the end of its log does. Lines that were told of another job, with whatever
  /// numbers, aren't repeated.
  std::string tell(const std::string& label, int status, const std::vector<std::string>& said,
                   const JobLog& log);

 private:
  std::set<std::string> told_;
};

}  // namespace npdr::pipeline
