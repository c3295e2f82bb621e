/// A simulator that is another program: theta -> x through files.
///
/// A call hands over a file of theta and takes back a file of x, one row a simulation. When it
/// fails (exit status, signal, time limit, a file that isn't there or not what it must be) it is
/// repeated `retries` times, and then its rows are halved down to single rows, so that only the
/// culprits are lost: they get a status and NaN, all others keep their values. A single row is
/// repeated, too, before it is given up. Where the program draws random numbers from the seeds that
/// it is given, a row's x doesn't depend on how the rows were split.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/random.h"
#include "core/types.h"
#include "pipeline/config/study.h"
#include "pipeline/process/shell_call.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Several may work at the same time, one a thread.
class ExternalSimulator {
 public:
  /// `external`: with a command and the names of its features; `info`: of the same study
  /// (config/simulator_info.h); `log`: what all calls print, up to a MiB, empty: nowhere;
  /// `threads`: what a call may use.
  ExternalSimulator(ExternalConfig external, sim::SimulatorInfo info, std::filesystem::path log,
                    int threads = num_threads());
  /// Brings the log to the disk.
  ~ExternalSimulator();
  ExternalSimulator(const ExternalSimulator&) = delete;
  ExternalSimulator& operator=(const ExternalSimulator&) = delete;

  /// Simulates rows of theta (n, P) in one call, if all goes well: (n, 1, 1, F). The program's seed
  /// of row i is drawn from the stream `first` with the row first.row + i.
  /// Row i is NaN where its status isn't ok; where an x isn't finite, the row diverged. Throws
  /// Error with the command and the end of its output when it can't be run or fails for each of
  /// many rows; Checkpointed when this process is asked to stop.
  sim::Trajectories simulate(const RowMatrix& theta, const StreamId& first);

  /// [s] of a call with `count` of `num_rows` rows: the share of the time limit, and the time that
  /// programs take to start. So the calls of all halves of one size take little more time than the
  /// first one may, however many rows hang.
  double time_limit(Index count, Index num_rows) const;

  /// Problem of the last call that failed, with the end of its output; "": none has.
  const std::string& last_failure() const { return last_failure_; }
  Index num_calls() const { return num_calls_; }

 private:
  struct Task {
    const RowMatrix& theta;
    std::vector<std::uint32_t> seeds;
    std::uint64_t first_row;
    sim::Trajectories result;
    Index num_done = 0;  ///< rows that have an x
    Index num_lost = 0;  ///< rows that were given up
  };

  void solve(Task& task, Index begin, Index end, bool is_bad);
  bool repeat(Task& task, Index begin, Index end, sim::RolloutStatus& status);
  bool call(Task& task, Index begin, Index end, sim::RolloutStatus& status);
  void give_up(Task& task, Index row, sim::RolloutStatus status);
  void note(const std::string& heading, const CallResult& result, const std::string& problem);
  [[noreturn]] void fail(const std::string& what) const;

  ExternalConfig external_;
  sim::SimulatorInfo info_;
  std::filesystem::path log_path_;
  int threads_;
  std::string log_;
  std::string last_failure_;
  Index num_calls_ = 0;
};

}  // namespace npdr::pipeline
