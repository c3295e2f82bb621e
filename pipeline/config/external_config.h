/// Settings of what takes the place of a built-in simulator: another program, or a finished
/// dataset. Both give a vector x of features for each theta, and no rollouts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "pipeline/config/source_traits.h"
#include "pipeline/store/file_format.h"

namespace npdr::pipeline {

/// At most one of `command` and `dataset`; neither: the simulator is a built-in one.
struct ExternalConfig {
  std::optional<std::string>
      command;  ///< reads a file of theta, writes a file of x; run by a shell
  std::optional<std::string> dataset;   ///< path of an HDF5 file that holds theta and x
  FileFormat format = FileFormat::csv;  ///< format of the files that the command reads and writes
  std::string folder;                   ///< where the command runs; resolved: an absolute path
  double time_limit = 3600.0;           ///< [s] of a call with all rows of a shard
  double start_time = 2.0;              ///< [s] that a call with fewer rows has besides its share
  Index retries = 1;                    ///< repetitions of a call that failed
  Index parallel_calls = 0;             ///< at once, of a stage; 0: as many as it has threads
  std::vector<std::string> features;    ///< columns of x, as `label` or `label [unit]`

  SourceKind kind() const {
    if (command) return SourceKind::command;
    return dataset ? SourceKind::dataset : SourceKind::built_in;
  }
};

}  // namespace npdr::pipeline
