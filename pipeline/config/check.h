/// Checks that posteriors are put to.
#pragma once

#include <array>
#include <string_view>

#include "core/enum_names.h"

namespace npdr::pipeline {

/// Checks of a network over many simulations, then those at x_o, of its simulations and training,
/// then those of evaluated samples, then that of a dataset.
enum class Check {
  sbc,
  coverage,
  tarp,
  local_c2st,
  predictive,
  ood,
  failures,
  training,
  sampling,
  residuals,
  bounds,
  contraction,
  fit,
  held_out,
  dataset
};

/// Conditions that a method must meet for a check to mean something to it.
enum class CheckNeeds {
  posterior,    ///< which all have that infer
  simulations,  ///< among which an observation can lie
  network,
  sampler,     ///< since the density is only known up to a constant
  likelihood,  ///< of the observation noise
};

/// Everything about a check that others than its own files need.
struct CheckTraits : EnumRow<Check> {
  std::string_view title;  ///< for people
  CheckNeeds needs;
  bool asks_simulator = true;  ///< for other simulations than those that inference has seen
  /// Concerns the network of round 1, which has learned from the whole prior, over fresh
  /// simulations of it; else the posterior of the last round.
  bool calibrates = false;
  bool has_p_value = true;
  std::string_view failure = "FAILS";  ///< the verdict where p is too small, or where it has none
  bool is_of_evaluation = false;       ///< judged for the report, without a diagnosis of its own
};

/// Every check, in the documented order.
constexpr auto enum_table(Check) {
  using enum Check;
  using enum CheckNeeds;
  return std::to_array<CheckTraits>({
      // name, title, needs, asks_simulator, calibrates, has_p_value, failure, is_of_evaluation
      {{sbc, "sbc"}, "SBC ranks, round 1", network, true, true},
      {{coverage, "coverage"}, "Expected coverage, round 1", network, true, true},
      {{tarp, "tarp"}, "TARP coverage, round 1", network, true, true},
      {{local_c2st, "local_c2st"}, "Local C2ST at x_o, round 1", network, true, true},
      {{predictive, "predictive"}, "Posterior predictive", posterior},
      {{ood, "ood"}, "x_o among simulations", simulations, false, false, true, "x_o lies OUTSIDE"},
      {{failures, "failures"},
       "Failures and parameters",
       simulations,
       false,
       false,
       true,
       "failures DEPEND on them"},
      {{training, "training"}, "Training", network, false, false, false, "NOT converged"},
      {{sampling, "sampling"},
       "Sampling",
       sampler,
       false,
       false,
       false,
       "chains DON'T agree",
       true},
      {{residuals, "residuals"},
       "Residuals",
       likelihood,
       false,
       false,
       false,
       "they AREN'T like the noise",
       true},
      {{bounds, "bounds"},
       "Bounds of the prior",
       posterior,
       false,
       false,
       false,
       "PRESSES against them",
       true},
      {{contraction, "contraction"},
       "Contraction",
       posterior,
       false,
       false,
       false,
       "it IS the prior",
       true},
      {{fit, "fit"}, "RMSE", posterior, true, false, false, "FAR above what can be reached", true},
      {{held_out, "held_out"},
       "Held-out rollouts",
       posterior,
       true,
       false,
       false,
       "predictions are TOO NARROW",
       true},
      {{dataset, "dataset"},
       "Dataset",
       simulations,
       false,
       false,
       false,
       "its rows AREN'T what they should be",
       true},
  });
}

inline CheckTraits traits_of(Check check) {
  const auto all = enum_table(check);
  return *std::ranges::find(all, check, &CheckTraits::value);
}

}  // namespace npdr::pipeline
