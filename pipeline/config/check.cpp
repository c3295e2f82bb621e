#include "pipeline/config/check.h"

#include <algorithm>

namespace npdr::pipeline {

std::string CheckTraits::why_unchecked(const Study& study, const MethodConfig& method) const {
  for (WhyUnchecked* const need : needs) {
    const std::string why = need == nullptr ? "" : need(study, method);
    if (!why.empty()) return why;
  }
  return "";
}

using inference::AlgorithmFamily;

std::string needs_simulator(const Study& study, const MethodConfig& /*method*/) {
  return study.source().simulates ? "" : "a dataset can't be asked for other simulations";
}

std::string needs_network(const Study& /*study*/, const MethodConfig& method) {
  return family_of(method) == AlgorithmFamily::network
             ? ""
             : "there is no network that could be asked about other observations";
}

std::string needs_simulations(const Study& /*study*/, const MethodConfig& method) {
  return learns(method) ? "" : "there are no simulations that it has learned from";
}

std::string needs_dataset(const Study& study, const MethodConfig& /*method*/) {
  return study.source().simulates ? "there is no dataset" : "";
}

std::string needs_predictions(const Study& /*study*/, const MethodConfig& method) {
  const bool begins_elsewhere =
      family_of(method) == AlgorithmFamily::likelihood && method.refine.infer_first_states;
  return begins_elsewhere ? "its predictions begin in recorded first states, whose noise only "
                            "'residuals' takes away"
                          : "";
}

std::string needs_sampler(const Study& /*study*/, const MethodConfig& method) {
  const AlgorithmFamily family = family_of(method);
  if (family == AlgorithmFamily::abc) {
    return "its chains are short, and agree as a whole; their R-hat is in the table of experiments";
  }
  const bool has_density =
      inference::traits_of(method.algorithm.kind).role == inference::NetworkRole::posterior;
  const bool is_sampled = family == AlgorithmFamily::likelihood ||
                          method.algorithm.kind == inference::Algorithm::npe_nle ||
                          (family == AlgorithmFamily::network && !has_density);
  return is_sampled ? "" : "its samples need no chains";
}

std::string needs_likelihood(const Study& /*study*/, const MethodConfig& method) {
  return family_of(method) == AlgorithmFamily::likelihood
             ? ""
             : "it has no likelihood whose noise could be unlike what is left of the recording";
}

std::string needs_rmse(const Study& study, const MethodConfig& /*method*/) {
  if (!study.source().gives_motion) return "features have no RMSE";
  if (std::ranges::count(study.evaluate.metrics, Metric::rmse) == 0) {
    return "evaluate.metrics lacks rmse";
  }
  return study.target.recording && !study.evaluate.floor ? "evaluate.floor is off" : "";
}

std::string needs_held_out(const Study& study, const MethodConfig& /*method*/) {
  return study.target.held_out == 0 ? "no rollouts are held out" : "";
}

}  // namespace npdr::pipeline
