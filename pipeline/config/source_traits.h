/// Kinds of sources that rows of simulations come from, and what can be expected of each.
#pragma once

namespace npdr::pipeline {

enum class SourceKind { built_in, command, dataset };

/// Traits that the rest of the pipeline asks for, in place of which source it is.
struct SourceTraits {
  SourceKind kind = SourceKind::built_in;
  const char* name = "simulator";  ///< for messages: "a command gives no rollouts"
  bool gives_motion = true;        ///< rollouts in channels; else a vector x of features a row
  bool simulates = true;           ///< any theta; else only rows that are there already
  bool calls_program = false;      ///< with files, and a seed that a row depends on besides theta
  bool has_nominal = true;         ///< parameters have nominal values, units and limits
  const char* advice = "";         ///< what to do where many rows fail

  /// Whether posteriors can be judged by the features that they predict.
  bool predicts_features() const { return simulates && !gives_motion; }
};

const SourceTraits& traits_of(SourceKind kind);

}  // namespace npdr::pipeline
