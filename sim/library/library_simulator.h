/// A simulator of the user's that is a shared library with the interface of npdr_simulator.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/types.h"
#include "sim/library/call_watch.h"
#include "sim/segments.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::sim {

/// Library to load, and its settings.
struct LibraryConfig {
  std::filesystem::path file;                  ///< of the shared library
  std::string settings = "{}";                 ///< JSON text that the library reads
  std::filesystem::path folder = ".";          ///< where its relative paths begin
  double time_limit = 3600.0;                  ///< [s] of a call of one of its functions
  CallWatch::End end_late = CallWatch::print;  ///< ends a program in which one takes longer
};

/// A library with as many open instances as there are threads that need one. Const calls are
/// thread-safe. A call of its functions that takes too long ends the program (call_watch.h).
class LibrarySimulator {
 public:
  /// Loads the library, and opens a first instance. Throws InputError with the file's name when it
  /// can't be loaded, isn't one of npdr's, won't open with these settings, or describes what isn't
  /// a simulator.
  explicit LibrarySimulator(const LibraryConfig& config);
  ~LibrarySimulator();

  /// Description that the library gives of itself; dt and num_steps are 0.
  const SimulatorInfo& info() const;

  /// Text that changes whenever results may, beside the library's file and settings; may be empty.
  const std::string& fingerprint() const;

  /// Simulates rows of theta (n, P) over the segments, in parallel. Row i depends on theta.row(i),
  /// seeds[i] (each < 2^31) and the segments alone, as far as the library keeps its promise. Rows
  /// that diverge, or have parameters outside of their limits, have a status and NaN. Throws
  /// ShapeError for a theta of other width, InputError for segments with other channels, Error when
  /// the library reports a failure, throws, or gives a status that there isn't.
  Trajectories replay(const Segments& segments, Index store_every, const RowMatrix& theta,
                      std::span<const std::uint32_t> seeds) const;

 private:
  class Instances;
  std::unique_ptr<Instances> instances_;
};

}  // namespace npdr::sim
