/// Programs of the user's: the files that their rows depend on, and the ways to ask one for rows,
/// by files or by requests to one that stays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/finding.h"
#include "core/shell_process.h"
#include "core/types.h"
#include "pipeline/config/external_config.h"
#include "sim/segments.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Words of the command that are files, such as a script, by their paths from `folder`; but not
/// those that it writes (after '>') and, where they aren't in it, programs in a folder `bin`, such
/// as an environment's python3, and files of the machine (/usr, /etc, /tmp, ...).
std::vector<std::string> named_paths(const std::string& command,
                                     const std::filesystem::path& folder);

/// Files, held against what they were when they were read.
class FileHashes {
 public:
  /// Reads files by their names in `folder`. Throws InputError for one that can't be read.
  FileHashes(const std::vector<std::string>& names, const std::filesystem::path& folder);

  /// Hashes by name.
  const std::map<std::string, std::string>& by_name() const { return hashes_; }

  /// Throws Error with the first file that isn't what it was: rows that are simulated with it
  /// belong to another key. Reads only files whose time or size has changed; what was edited and
  /// put back is what it was. A file that can't be read just now is looked at the next time.
  void require_unchanged();

 private:
  using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>;  // and the size
  static Stamp stamp_of(const std::filesystem::path& path);

  std::filesystem::path folder_;
  std::map<std::string, std::string> hashes_;
  std::map<std::string, Stamp> stamps_;
};

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
/// that failed in another; where it gives motion it reads segments, too, and writes
/// states. Keeps a reference to `program`, as the next does.
std::unique_ptr<ProgramCall> make_file_call(const Program& program);

/// The command with {theta} and {x} replaced by the paths of the files; a file whose placeholder
/// doesn't occur is appended, theta first.
std::string filled_command(const std::string& command, const std::filesystem::path& theta,
                           const std::filesystem::path& x);

/// Reasons of failures by row, from the file of NPDR_FAILED: each line holds a row's number in
/// theta from 0, a blank, and the reason; the first line about a row counts. Empty where there is
/// no such file. Throws InputError where `path` is no file, can't be read, or has a line of another
/// kind or of none of `num_rows` rows.
std::map<Index, std::string> read_failed_rows(const std::filesystem::path& path, Index num_rows);

/// A program that stays; the interface is in docs/worker-protocol.md.
std::unique_ptr<ProgramCall> make_worker_call(const Program& program);

}  // namespace npdr::pipeline
