/// One way to ask a program of the user's for rows: files, or requests to one that stays.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/finding.h"
#include "core/types.h"
#include "pipeline/config/external_config.h"
#include "pipeline/sources/lost_numbers.h"
#include "sim/segments.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Rows that are asked for.
struct ProgramRows {
  RowMatrix theta;                       ///< (n, P)
  std::span<const std::uint32_t> seeds;  ///< (n), each < 2^31
  std::uint64_t first_row = 0;           ///< of the simulation, for people
  double time_limit = 0.0;               ///< [s]
};

/// How it went. When it failed, `status` is that of a row that it would be about.
struct ProgramOutcome {
  bool succeeded = true;
  bool cannot_run = false;  ///< there is no such program
  sim::RolloutStatus status = sim::RolloutStatus::ok;
  std::string summary;             ///< "exit status 1 after 0.5 s"
  std::string problem;             ///< also where only rows failed; empty: none
  std::string output;              ///< that it printed
  Findings warnings;               ///< about rows, or the program
  std::optional<LostNumber> lost;  ///< of the first row that diverged by its numbers
};

class ProgramCall {
 public:
  virtual ~ProgramCall() = default;

  /// Fills `result`, which has room for the rows; those that failed on their own have a status and
  /// NaN. Throws Checkpointed when this process is asked to stop, Error when no program can be
  /// started.
  virtual ProgramOutcome call(const ProgramRows& rows, sim::Trajectories& result) = 0;

  /// Rows that nobody has simulated yet.
  virtual sim::Trajectories empty(Index num_rows) const = 0;

  /// The key of the study and its value: "simulator.command = 'python3 sim.py'".
  virtual std::string words() const = 0;
};

/// Rollouts that rows are asked over; a program that gives features needs none.
struct ProgramInputs {
  sim::Segments segments;
  Index store_every = 1;
};

/// A program that reads a file of theta and writes a file of x, each time anew, and may name rows
/// that failed in another (failed_rows.h); with `inputs` it reads them, too, and writes states.
/// `threads`: what a call may use.
std::unique_ptr<ProgramCall> make_file_call(const ExternalConfig& external,
                                            const sim::SimulatorInfo& info,
                                            const ProgramInputs* inputs, int threads);

/// A program that stays; the interface is in docs/worker-protocol.md.
std::unique_ptr<ProgramCall> make_worker_call(const ExternalConfig& external,
                                              const sim::SimulatorInfo& info,
                                              const ProgramInputs& inputs, int threads);

}  // namespace npdr::pipeline
