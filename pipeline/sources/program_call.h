/// One way to ask a program of the user's for rows: files, or requests to one that stays.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/shell_process.h"
#include "core/types.h"
#include "pipeline/config/external_config.h"
#include "sim/segments.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// A program, and the rollouts that it is asked over.
struct Program {
  ExternalConfig external;
  sim::SimulatorInfo info;
  sim::Segments segments;  ///< where it gives features: feature_segments()
  Index store_every = 1;
  int threads = 1;  ///< that a call may use

  bool gives_motion() const { return traits_of(external.kind()).gives_motion; }
  /// The key of the study and its value: "simulator.command = 'python3 sim.py'".
  std::string words() const;
  /// `text` as a command in the program's folder and with its environment.
  ShellCommand shell_command(const std::string& text) const;
};

/// Rows that are asked for.
struct ProgramRows {
  RowMatrix theta;                   ///< (n, P)
  std::vector<std::uint32_t> seeds;  ///< (n), each < 2^31
  std::uint64_t first_row = 0;       ///< of the simulation, for people
  double time_limit = 0.0;           ///< [s]
};

/// What came of them.
struct ProgramReply {
  /// Of a call that failed: that of a row that it would be about.
  sim::RolloutStatus status = sim::RolloutStatus::ok;
  bool cannot_run = false;  ///< there is no such program
  std::string summary;      ///< "exit status 1 after 0.5 s"
  std::string problem;      ///< also where only rows failed; empty: none
  std::string output;       ///< that it printed
  Findings warnings;        ///< about rows, or the program

  /// States after each step of all segments (n, N, C), until the next call; empty where all rows
  /// failed.
  std::span<const double> states;
  std::vector<sim::RolloutStatus> row_status;  ///< (n), of rows that failed on their own

  bool succeeded() const { return status == sim::RolloutStatus::ok; }
};

class ProgramCall {
 public:
  virtual ~ProgramCall() = default;

  /// Throws Checkpointed when this process is asked to stop, Error when no program can be started.
  virtual ProgramReply call(const ProgramRows& rows) = 0;
};

/// A program that reads a file of theta and writes a file of x, each time anew, and may name rows
/// that failed in another (failed_rows.h); where it gives motion it reads segments, too, and writes
/// states. Keeps a reference to `program`, as the next does.
std::unique_ptr<ProgramCall> make_file_call(const Program& program);

/// A program that stays; the interface is in docs/worker-protocol.md.
std::unique_ptr<ProgramCall> make_worker_call(const Program& program);

/// The one that the study asks for.
std::unique_ptr<ProgramCall> make_program_call(const Program& program);

}  // namespace npdr::pipeline
