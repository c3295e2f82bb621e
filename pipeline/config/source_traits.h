/// Kinds of sources that rows of simulations come from, and what can be expected of each.
#pragma once

#include <array>

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

}  // namespace npdr::pipeline
