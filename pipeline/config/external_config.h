/// Sources of simulated rows: kinds, traits, and settings of all but the built-in simulators: a
/// program, a shared library, a model of MuJoCo, or a finished dataset. They give rollouts in
/// channels, as built-in simulators do, or a vector x of features for each theta.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/feature_names.h"
#include "core/types.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {

enum class SourceKind {
  built_in,
  command,         ///< gives features
  motion_command,  ///< a command of a study that names state channels: gives rollouts
  worker,
  library,
  mjcf,
  dataset,
};

/// Traits that the rest of the pipeline asks for, in place of which source it is.
struct SourceTraits {
  SourceKind kind = SourceKind::built_in;
  const char* name = "simulator";  ///< for messages: "a command gives no rollouts"
  bool gives_motion = true;        ///< rollouts in channels; else a vector x of features a row
  bool simulates = true;           ///< any theta; else only rows that are there already
  bool is_built_in = false;        ///< one of sim/, with its settings, equations and policies
  bool describes_itself = false;   ///< its channels and parameters; else the study does
  bool calls_program = false;      ///< of the user's, which may crash, hang, and print
  bool takes_seeds = false;        ///< a row depends on a seed besides theta
  const char* advice = "";         ///< what to do where many rows fail

  /// Whether rows come from code of the user's, whose calls end after simulator.time_limit.
  bool runs_users_code() const { return simulates && !is_built_in; }
  /// Whether posteriors can be judged by the features that they predict.
  bool predicts_features() const { return simulates && !gives_motion; }
};

const SourceTraits& traits_of(SourceKind kind);

/// Keys of [simulator] that say where rows come from; a study has one of them.
inline constexpr std::array<const char*, 6> kSourceKeys = {"name",    "command", "worker",
                                                           "library", "mjcf",    "dataset"};

/// A domain parameter of the user's simulator, as a study describes it.
struct DescribedParameter {
  std::string name, unit = "1";
  std::optional<double> nominal = {}, lower = {}, upper = {};
  double period = 0.0;
  std::string description = {};
};

/// A place in state space that rollouts should come to rest at.
struct GoalConfig {
  std::map<std::string, double> place;  ///< by state channel
  double radius = 0.0, speed = 0.0;
  std::string description;
};

/// Any TOML value, as JSON text.
struct FreeTable {
  std::string json = "{}";
};

/// At most one of `command`, `worker`, `library`, `mjcf` and `dataset`; none: the simulator is a
/// built-in one.
struct ExternalConfig {
  std::optional<std::string> command, worker, library, mjcf, dataset;
  std::vector<std::string> states, actions;
  std::vector<DescribedParameter> parameters;
  std::vector<std::string> files;
  FreeTable settings;
  double dt = 0.0;  ///< [s]
  Index num_steps = 0;
  std::vector<std::vector<double>> initial_states;
  GoalConfig goal;
  FileFormat format = FileFormat::csv;
  std::string folder;                            ///< resolved: an absolute path
  double time_limit = 3600.0, start_time = 2.0;  ///< [s]
  Index retries = 1, parallel_calls = 0;
  std::vector<std::string> features;
  NamesFrom names_from = NamesFrom::study;  ///< resolved: who has named the features

  SourceKind kind() const;
};

}  // namespace npdr::pipeline
