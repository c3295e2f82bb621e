/// A simulator that is another program, which may crash, hang, or write what isn't a row.
///
/// A call that fails (exit status, signal, time limit, no result or a wrong one) is repeated
/// `retries` times. Then its rows are halved down to single ones. A single row is repeated, too,
/// before it is given up: only the culprits get a status and NaN. Rows that the program itself says
/// to have failed, while others went well, are asked for together in one call more, `retries`
/// times, and again for as long as that brings some of them back. Where the program draws random
/// numbers from the seeds that it is given, a row's result doesn't depend on how the rows were
/// split.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/random.h"
#include "core/types.h"
#include "pipeline/sources/program_call.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Failed rows in succession after which a row that went well tests the program, where no limit of
/// failures is known: if half of all rows fail, by chance once in 2^33 rows.
inline constexpr Index kHopelessRows = 32;

/// Failures that are less likely than this mean that the simulator fails more often than it may.
inline constexpr double kHopelessChance = 1e-9;

/// P(at least `num_failed` of `num_rows` rows fail) where a share of `max_failed_fraction` does.
double chance_of_failures(Index num_failed, Index num_rows, double max_failed_fraction);

/// The same number as kHopelessRows where a share of `max_failed_fraction` may fail: by chance once
/// in 10^9 times; 7 for 0.05, 4 at least.
Index hopeless_rows(double max_failed_fraction);

/// Several may work at the same time, one a thread.
class ExternalSimulator {
 public:
  /// `log`: what all calls print, up to a MiB; empty: nowhere.
  ExternalSimulator(Program program, std::filesystem::path log,
                    Index hopeless_rows = kHopelessRows);
  /// Brings the log to the disk.
  ~ExternalSimulator();
  ExternalSimulator(const ExternalSimulator&) = delete;
  ExternalSimulator& operator=(const ExternalSimulator&) = delete;

  /// Simulates rows of theta (n, P) in one call, if all goes well. `first` names the random numbers
  /// of row 0. `num_rows`: what the time limit is for; a call has its share of it. Row i is NaN
  /// where its status isn't ok; where a value isn't finite, the row diverged. Rows outside of their
  /// parameters' limits aren't simulated. Throws Error with the program and the end of its output
  /// when it can't be run, or fails for each of `hopeless_rows` and for one that went well before,
  /// if there was any; Checkpointed when this process is asked to stop.
  sim::Trajectories simulate(const RowMatrix& theta, const StreamId& first, Index num_rows = 0);

  /// The time limit [s] of a call with `count` of `num_rows` rows: the share of the whole one, and
  /// the time that programs take to start. So the calls of all halves of one size take little more
  /// time than the first one may, however many rows hang.
  double time_limit(Index count, Index num_rows) const;

  /// Brings the log to the disk, and begins another.
  void log_to(std::filesystem::path log);

  /// The words of the call that a row was lost to, the last of such; "": none was.
  const std::string& last_loss() const { return loss_; }
  /// The number that made a row diverge, the last of such: "row 12 has nan in 'omega', step 17 of
  /// rollout 2"; "": none did.
  const std::string& lost_number() const { return lost_number_; }
  /// The words of the call that failed first of the last rows that any failed of, even if it went
  /// well when it was repeated; "": none did.
  const std::string& last_failure() const { return last_failure_; }
  /// Of the last call that had any; empty: none had.
  const Findings& last_warnings() const { return last_warnings_; }
  Index num_calls() const { return num_calls_; }

 private:
  // Rows that were asked for, and what has become of them.
  struct Work {
    RowMatrix theta;
    StreamId first;           ///< of row 0
    Index num_rows;           ///< that the time limit is for
    std::vector<Index> rows;  ///< that can be simulated
    sim::Trajectories result;
    std::set<Index> named = {};  ///< rows that the program said to have failed
    std::string why = {};        ///< of the last of these
    Index num_lost = 0;          ///< rows that were given up
    bool has_failed = false;

    std::uint64_t number(Index row) const;  ///< of the simulation, for people
  };
  using Rows = std::span<const Index>;

  Work begin(const RowMatrix& theta, const StreamId& first, Index num_rows) const;
  void solve(Work& work, Rows rows, bool is_bad);
  void require_a_good_row(Work& work);
  void repeat_named(Work& work);
  sim::RolloutStatus repeat(Work& work, Rows rows);
  sim::RolloutStatus call(Work& work, Rows rows);
  void take(Work& work, Rows rows, const ProgramReply& reply);
  std::string store(Work& work, Index row, sim::RolloutStatus status,
                    std::span<const double> states) const;
  void give_up(Work& work, Index row, sim::RolloutStatus status);
  void count_lost(Index count);
  void note(const std::string& heading, const ProgramReply& reply, Work& work);
  void log(const std::string& text);
  void write_log();
  [[noreturn]] void fail(const std::string& what, const std::string& why) const;

  Program program_;
  std::unique_ptr<ProgramCall> call_;
  std::filesystem::path log_path_;
  std::string log_;
  std::string last_failure_;
  std::string loss_;
  std::string lost_number_;
  Findings last_warnings_;
  Index num_calls_ = 0;
  Index hopeless_rows_;
  std::optional<Work> good_;  ///< the last row that has a result
  Index num_lost_ = 0;        ///< rows since then
};

}  // namespace npdr::pipeline
