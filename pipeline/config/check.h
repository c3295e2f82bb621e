/// Checks that posteriors are put to: the one table of their names, of what each asks and refutes,
/// and of the methods that it means something to. What each says of results is judge() of
/// pipeline/findings/probe.h.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "core/enum_names.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Checks of a network over many simulations, then those at x_o, of its simulations and training,
/// then those of evaluated samples, then that of a dataset.
enum class Check {
  sbc,
  coverage,
  tarp,
  local_c2st,
  predictive,
  width,
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

/// What a check looks at.
enum class CheckInput {
  calibration,  ///< fresh simulations of the prior, and the network of round 1, which has learned
                ///< from all of it: a diagnosis
  posterior,    ///< that of the last round, its simulations, its training: a diagnosis
  samples,      ///< evaluated ones, or the rows of a dataset: judged for the report
};

/// Why a check means nothing to a method that infers, for people; "": it does mean something.
using WhyUnchecked = std::string(const Study& study, const MethodConfig& method);

WhyUnchecked needs_simulator, needs_network, needs_simulations, needs_dataset, needs_predictions,
    needs_sampler, needs_likelihood, needs_rmse, needs_held_out;

/// What checks of a kind share.
struct CheckKind {
  std::array<WhyUnchecked*, 2> needs = {};  ///< nullptr: nothing else
  CheckInput input = CheckInput::samples;
  std::string_view refutes = "parameters, error bars";  ///< can't be trusted where it fails
  bool has_p_value = false;
  bool is_of_some_methods = false;  ///< nothing is missing where it means nothing to a method
};

/// Everything about a check but what it says of results.
struct CheckTraits : EnumRow<Check>, CheckKind {
  std::string_view title, question;

  /// Reason of the first unmet need, for people; "": all needs are met.
  std::string why_unchecked(const Study& study, const MethodConfig& method) const;
};

/// Every check, in the documented order.
constexpr auto enum_table(Check) {
  using enum Check;
  using enum CheckInput;
  constexpr CheckKind calibrates{.needs = {needs_simulator, needs_network},
                                 .input = calibration,
                                 .refutes = "error bars",
                                 .has_p_value = true};
  constexpr std::string_view all = "parameters, error bars, predictions";
  return std::to_array<CheckTraits>({
      {{sbc, "sbc"},
       calibrates,
       "SBC ranks, round 1",
       "are posteriors of the right place and width, parameter by parameter?"},
      {{coverage, "coverage"},
       calibrates,
       "Expected coverage, round 1",
       "do credible regions hold the truth as often as they say?"},
      {{tarp, "tarp"},
       calibrates,
       "TARP coverage, round 1",
       "the same, by regions around random points"},
      {{local_c2st, "local_c2st"},
       calibrates,
       "Local C2ST at x_o, round 1",
       "can a classifier tell the posterior at the observation from the true one?"},
      {{predictive, "predictive"},
       {.needs = {needs_simulator, needs_predictions},
        .input = posterior,
        .refutes = "parameters, predictions",
        .has_p_value = true},
       "Posterior predictive",
       "do posterior samples predict what was observed?"},
      {{width, "width"},
       {.needs = {needs_simulator, needs_predictions}, .input = posterior, .refutes = "error bars"},
       "Width",
       "would fresh simulations of its samples tell parameters far better than the posterior "
       "does?"},
      {{ood, "ood"},
       {.needs = {needs_simulations}, .input = posterior, .refutes = all, .has_p_value = true},
       "x_o among simulations",
       "does the observation lie among the simulations?"},
      {{failures, "failures"},
       {.needs = {needs_simulations}, .input = posterior, .has_p_value = true},
       "Failures and parameters",
       "does it depend on the parameters which simulations fail?"},
      {{training, "training"},
       {.needs = {needs_network}, .input = posterior},
       "Training",
       "has training ended, and not far below the validation loss?"},
      {{sampling, "sampling"},
       {.needs = {needs_sampler}, .is_of_some_methods = true},
       "Sampling",
       "do its chains agree, or enough of its weighted draws count?"},
      {{residuals, "residuals"},
       {.needs = {needs_likelihood}, .refutes = "error bars", .is_of_some_methods = true},
       "Residuals",
       "does a refinement leave of the recording what its noise model says?"},
      {{bounds, "bounds"},
       {.refutes = "parameters"},
       "Bounds of the prior",
       "does the posterior press against the prior's bounds?"},
      {{contraction, "contraction"},
       {},
       "Contraction",
       "is the posterior narrower than the prior?"},
      {{fit, "fit"},
       {.needs = {needs_simulator, needs_rmse}, .refutes = all},
       "RMSE",
       "is the samples' RMSE near the smallest that can be reached, and of hardly any as large as "
       "the prior's?"},
      {{held_out, "held_out"},
       {.needs = {needs_simulator, needs_held_out}, .refutes = "error bars, predictions"},
       "Held-out rollouts",
       "do bands of predictions hold rollouts that inference hasn't seen?"},
      {{dataset, "dataset"},
       {.needs = {needs_simulations, needs_dataset}},
       "Dataset",
       "is the dataset's theta of the prior, and no row there twice?"},
  });
}

inline CheckTraits traits_of(Check check) {
  const auto all = enum_table(check);
  return *std::ranges::find(all, check, &CheckTraits::value);
}

}  // namespace npdr::pipeline
