/// Settings of what takes the place of a built-in simulator: a program, a shared library, a model
/// of MuJoCo, or a finished dataset. They give rollouts in channels, as built-in simulators do, or
/// a vector x of features for each theta.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/feature_names.h"
#include "core/types.h"
#include "pipeline/config/source_traits.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {

/// A domain parameter of the user's simulator, as a study describes it.
struct DescribedParameter {
  std::string name;
  std::string unit = "1";
  std::optional<double> nominal = {};
  std::optional<double> lower = {};  ///< none: no limit
  std::optional<double> upper = {};
  double period = 0.0;  ///< values this far apart are the same system; 0: none are
  std::string description = {};
};

/// A place in state space that rollouts should come to rest at.
struct GoalConfig {
  std::map<std::string, double> place;  ///< by state channel
  double radius = 0.0;                  ///< 0: there is no goal
  double speed = 0.0;                   ///< 0: any
  std::string description;
};

/// Any TOML value, as JSON text.
struct FreeTable {
  std::string json = "{}";
};

/// At most one of `command`, `worker`, `library`, `mjcf` and `dataset`; none: the simulator is a
/// built-in one.
struct ExternalConfig {
  std::optional<std::string>
      command;                        ///< reads a file of theta, writes a file of x; run by a shell
  std::optional<std::string> worker;  ///< answers requests through pipes; started by a shell
  std::optional<std::string> library;  ///< path of a shared library
  std::optional<std::string> mjcf;     ///< path of a model of MuJoCo
  std::optional<std::string> dataset;  ///< path of an HDF5 file that holds theta and x
  std::vector<std::string> states;     ///< state channels, as `label` or `label [unit]`
  std::vector<std::string> actions;    ///< the same of actions
  std::vector<DescribedParameter> parameters;
  std::vector<std::string> files;                   ///< that rows depend on, too
  FreeTable settings;                               ///< that the library reads
  double dt = 0.0;                                  ///< [s] of a truth's rollouts
  Index num_steps = 0;                              ///< of a truth's rollouts
  std::vector<std::vector<double>> initial_states;  ///< of a truth's rollouts, in turn
  GoalConfig goal;
  FileFormat format = FileFormat::csv;  ///< format of the files that the command reads and writes
  std::string folder;                   ///< where the program runs; resolved: an absolute path
  double time_limit = 3600.0;           ///< [s] of a call with all rows of a shard, or of a library
  double start_time = 2.0;              ///< [s] that a call with fewer rows has besides its share
  Index retries = 1;                    ///< repetitions of a call that failed
  Index parallel_calls = 0;             ///< at once, of a stage; 0: as many as it has threads
  std::vector<std::string> features;    ///< columns of x, as `label` or `label [unit]`
  NamesFrom names_from = NamesFrom::study;  ///< resolved: who has named the features

  SourceKind kind() const;
};

}  // namespace npdr::pipeline
