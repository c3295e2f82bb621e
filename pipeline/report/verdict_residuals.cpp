// Verdict on what a refinement leaves of its recording.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/text.h"
#include "pipeline/report/verdict_parts.h"

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

bool is_excessive(const EvaluatedRun& run) {
  constexpr double most = 2.0;
  return !is_by_chance(run) && !(excess_of(run) <= most);
}

// What was found of the run whose residuals are farthest from the noise.
std::string words_of(const ReportData& data, const EvaluatedRun& run) {
  const sim::ErrorMemory& found = *run.notes.residuals;
  const Index c = found.worst_channel();
  std::string words = fmt::format(
      "what its likeliest parameters leave of channel '{}' is not noise of [observation_noise]",
      data.target.state_channels[static_cast<std::size_t>(c)].label);
  std::vector<std::string> details;
  if (found.memory(c) > 1.3) {
    details.push_back(fmt::format("{:.3g} errors in a row say the same", found.memory(c)));
  }
  if (found.size(c) > 1.3) {
    details.push_back(fmt::format("they are {:.3g} times as large", std::sqrt(found.size(c))));
  }
  if (!details.empty()) words += ": " + join(details, ", and ");
  return words + fmt::format(
                     "; its posterior is at least about {:.2g} times too narrow, and where the "
                     "simulator lacks something any number of deviations beside the truth",
                     std::sqrt(excess_of(run)));
}

// Whether first states that were recorded count as exact.
bool trusts_first_states(const ReportData& data, const MethodConfig& method) {
  const Study& study = data.plan.study;
  return study.source().gives_motion && study.target.recording && !method.refine.infer_first_states;
}

bool is_heavy_tailed(const ObservationNoise& noise) {
  return noise.degrees_of_freedom || noise.degrees_of_freedom_prior;
}

// Parameters may make up for what first states do, and leave nothing of it, at the full power of
// the likelihood.
std::string word_of_first_states(const ReportData& data, const MethodConfig& method,
                                 const Runs& runs) {
  const bool is_full = std::ranges::any_of(
      runs, [](const EvaluatedRun* run) { return run->notes.certificate->power == 1.0; });
  if (!is_full || !trusts_first_states(data, method) ||
      is_heavy_tailed(data.plan.study.observation_noise)) {
    return "";
  }
  return "it takes recorded first states for exact, and parameters may make up for the noise that "
         "they have; unless the device began at rest, refine.infer_first_states = true";
}

// What a study may do that it doesn't yet.
std::string advice(const ReportData& data, const MethodConfig& method) {
  const ObservationNoise& noise = data.plan.study.observation_noise;
  const bool is_correlated = noise.correlation || noise.correlation_prior;
  std::vector<std::string> ways;
  const bool moves = data.plan.study.source().gives_motion;
  if (trusts_first_states(data, method)) {
    ways.emplace_back(
        fmt::format("refine.infer_first_states = true{} where the first states are as "
                    "noisy as the others (a device that began at rest has none of it)",
                    is_heavy_tailed(noise) ? ", without degrees of freedom," : ""));
  }
  if (moves && !is_correlated) {
    ways.emplace_back("observation_noise.correlation_prior for errors that last");
  }
  if (!noise.scale_prior) ways.emplace_back("observation_noise.scale_prior for their size");
  if (!method.refine.sampling.cross_validate) {
    ways.emplace_back(
        data.target.num_rollouts() > 1
            ? "refine.cross_validate = true where the simulator isn't quite right"
            : "refine.likelihood_power below 1 where the simulator isn't quite right");
  }
  ways.emplace_back(moves ? "a simulator that has what is missing, such as a delay or dry friction"
                          : "a simulator that has what is missing");
  return join(ways, ", ");
}

}  // namespace

Verdict judge_residuals(const ReportData& data, const std::string& method) {
  const Runs runs = data.runs_of(method);
  if (std::ranges::any_of(runs, [](const EvaluatedRun* run) { return !run->notes.residuals; })) {
    return {
        Check::residuals, Judgment::unknown, "can't tell",
        "its likeliest parameters couldn't be simulated again; see why in the log of stage infer"};
  }
  const auto worst = std::ranges::max_element(runs, {}, [](const EvaluatedRun* run) {
    return std::isnan(excess_of(*run)) ? kInfinity : excess_of(*run);
  });
  const auto failed = static_cast<std::size_t>(
      std::ranges::count_if(runs, [](const EvaluatedRun* run) { return is_excessive(*run); }));
  const std::string text = fmt::format("variance {:.2g} times the noise's", excess_of(**worst));
  const MethodConfig& config = data.plan.study.method(method);
  const std::string reason = fmt::format("{}: {}", words_of(data, **worst), advice(data, config));
  if (failed == 0) {
    return {Check::residuals, Judgment::passes, "passes, " + text,
            is_by_chance(**worst) ? word_of_first_states(data, config, runs) : reason};
  }
  return {Check::residuals, Judgment::fails,
          std::string(traits_of(Check::residuals).failure) + seeds_text(failed, runs.size()) +
              ", " + text,
          reason};
}

}  // namespace npdr::pipeline
