// What a refinement leaves of its recording.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// By how much its posterior's variances are too small, at its power of the likelihood.
double excess_of(const EvaluatedRun& run) {
  return run.notes.certificate->power * run.notes.residuals->excess();
}

bool is_by_chance(const EvaluatedRun& run) {
  const sim::ErrorMemory& found = *run.notes.residuals;
  return excess_of(run) <= sim::largest_by_chance(found.num_errors, found.memory.size());
}

// A posterior that is narrower than it should be by no more than sqrt(2) is a note.
constexpr double kMostExcess = 2.0;

bool is_excessive(const EvaluatedRun* run) {
  return !is_by_chance(*run) && !(excess_of(*run) <= kMostExcess);
}

// What was found of the run whose residuals are farthest from the noise, and one thing to do that
// the study doesn't yet.
Finding words_of_residuals(const MethodResults& m, const EvaluatedRun& run) {
  const sim::ErrorMemory& found = *run.notes.residuals;
  const ObservationNoise& noise = m.study.observation_noise;
  const Index c = found.worst_channel();
  const bool lasts = found.memory(c) > std::max(1.3, found.size(c));
  std::string fault = "are not like the stated noise", advice = advice_on_model(m.study);
  if (lasts) {
    fault = fmt::format("last for {:.3g} time steps, unlike noise", found.memory(c));
  } else if (found.size(c) > 1.3) {
    fault = fmt::format("are {:.3g} times the stated noise", std::sqrt(found.size(c)));
  }
  if (lasts && m.study.source().gives_motion && !noise.is_correlated()) {
    advice = "Set correlation_prior = [0.5, 1.5] in [observation_noise], for errors that last";
  } else if (!lasts && !noise.scale_prior) {
    advice =
        "Set scale_prior = [0.2, 1.0] in [observation_noise], which infers how large the noise is";
  } else if (m.data.target.num_rollouts() > 1 && !m.method.refine.sampling.cross_validate) {
    advice = "Set cross_validate = true in [method.refine]";
  }
  return {
      .what = fmt::format("errors of the best parameters in channel '{}' {}",
                          m.data.target.state_channels[static_cast<std::size_t>(c)].label, fault),
      .advice = advice};
}

}  // namespace

template <>
Findings judge<Check::residuals>(const MethodResults& m) {
  const auto lacks_them = [](const EvaluatedRun* run) { return !run->notes.residuals; };
  if (std::ranges::any_of(m.runs, lacks_them)) {
    return {cannot_tell({.what = "the likeliest parameters could not be simulated again",
                         .advice = "Read why in the log of stage infer"})};
  }
  const EvaluatedRun& worst = **std::ranges::max_element(m.runs, {}, [](const EvaluatedRun* run) {
    return std::isnan(excess_of(*run)) ? kInfinity : excess_of(*run);
  });
  const Index failed = std::ranges::count_if(m.runs, is_excessive);
  Finding said;
  if (failed > 0 || !is_by_chance(worst)) said = words_of_residuals(m, worst);
  said.evidence =
      fmt::format("variances of parameters should be {:.2g} times as large (fine up to {:.2g})",
                  excess_of(worst), kMostExcess);
  if (failed > 0) said.evidence += seeds_text(failed, m.runs.size());
  return {failed > 0 ? fails(said) : passes(said)};
}

}  // namespace npdr::pipeline
