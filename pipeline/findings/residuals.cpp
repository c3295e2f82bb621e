// What a refinement leaves of its recording.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/text.h"
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

bool is_excessive(const EvaluatedRun* run) {
  constexpr double most = 2.0;
  return !is_by_chance(*run) && !(excess_of(*run) <= most);
}

// What was found of the run whose residuals are farthest from the noise.
std::string words_of_residuals(const ReportData& data, const EvaluatedRun& run) {
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

// What a study may do that it doesn't yet.
std::string advice_on_residuals(const MethodResults& m) {
  const ObservationNoise& noise = m.study.observation_noise;
  std::vector<std::string> ways;
  const bool moves = m.study.source().gives_motion;
  if (m.study.target.recording && !m.method.refine.infer_first_states) {
    ways.emplace_back(
        fmt::format("refine.infer_first_states = true{} where the first states are as "
                    "noisy as the others (a device that began at rest has none of it)",
                    noise.is_heavy_tailed() ? ", without degrees of freedom," : ""));
  }
  if (moves && !noise.is_correlated()) {
    ways.emplace_back("observation_noise.correlation_prior for errors that last");
  }
  if (!noise.scale_prior) ways.emplace_back("observation_noise.scale_prior for their size");
  if (!m.method.refine.sampling.cross_validate) {
    ways.emplace_back(
        m.data.target.num_rollouts() > 1
            ? "refine.cross_validate = true where the simulator isn't quite right"
            : "refine.likelihood_power below 1 where the simulator isn't quite right");
  }
  ways.emplace_back(moves ? "a simulator that has what is missing, such as a delay or dry friction"
                          : "a simulator that has what is missing");
  return join(ways, ", ");
}

}  // namespace

template <>
Finding judge<Check::residuals>(const MethodResults& m) {
  const auto lacks_them = [](const EvaluatedRun* run) { return !run->notes.residuals; };
  if (std::ranges::any_of(m.runs, lacks_them)) {
    return cannot_tell(
        "its likeliest parameters couldn't be simulated again; see why in the log of stage infer");
  }
  const EvaluatedRun& worst = **std::ranges::max_element(m.runs, {}, [](const EvaluatedRun* run) {
    return std::isnan(excess_of(*run)) ? kInfinity : excess_of(*run);
  });
  const Index failed = std::ranges::count_if(m.runs, is_excessive);
  const std::string size = fmt::format("variance {:.2g} times the noise's", excess_of(worst));
  if (failed == 0 && is_by_chance(worst)) return passes(size);
  const std::string what =
      fmt::format("{}: {}", words_of_residuals(m.data, worst), advice_on_residuals(m));
  if (failed == 0) return passes(size, what);
  return fails("they AREN'T like the noise" + seeds_text(failed, m.runs.size()) + ", " + size,
               what);
}

}  // namespace npdr::pipeline
