// Whether, where and why a simulator doesn't explain a recording.
#include <fmt/format.h>

#include <algorithm>

#include "pipeline/findings/probe.h"
#include "pipeline/predictions/misfit.h"

namespace npdr::pipeline {
namespace {

// "in the first 0.6 s", "from 1.2 s on", "between 1.2 and 1.8 s"; "": all the time.
std::string time_of(const analysis::Concentration& worst, const RecordingMisfit& misfit,
                    const Target& target) {
  const Index parts = misfit.left.rows() / misfit.num_rollouts;
  const double part =
      target.dt * static_cast<double>(target.num_steps()) / static_cast<double>(parts);
  const double begin = part * static_cast<double>(worst.begin);
  const double end = part * static_cast<double>(worst.end);
  if (worst.begin == 0 && worst.end == parts) return "";
  if (worst.begin == 0) return fmt::format(" in the first {:.2g} s", end);
  if (worst.end == parts) return fmt::format(" from {:.2g} s on", begin);
  return fmt::format(" between {:.2g} and {:.2g} s", begin, end);
}

}  // namespace

std::string words_of_misfit(const ReportData& data) {
  const RecordingMisfit& m = *data.baseline.misfit;
  std::string words = fmt::format(
      "the best parameters leave {:.2g} times the {} ({:.2g} at most are fine): your simulator "
      "lacks an effect, or {}",
      m.times, m.noise_is_given ? "noise of [observation_noise]" : "scatter of neighboring samples",
      m.limit,
      m.noise_is_given ? "the noise is too small"
                       : "errors last for many samples, and an inferred noise takes either up");
  // What is about as good as a right simulator, or takes away most of the rest.
  constexpr double most_of_rest = 0.25;
  if (!m.cause.empty() &&
      m.times_of_cause < std::max(kMostOfGivenNoise, 1.0 + most_of_rest * (m.times - 1.0))) {
    return fmt::format("{}. With {} {:.2g} times would be left", words, m.cause, m.times_of_cause);
  }
  return words + ". Look for friction, a delay or a wrong clock";
}

std::string where_wrong(const ReportData& data) {
  const auto& misfit = data.baseline.misfit;
  if (!misfit || !misfit->is_beyond()) return "";
  const auto worst = analysis::concentration(*misfit);
  if (!worst) return "";
  const auto at = [](const auto& items, Index i) { return items[static_cast<std::size_t>(i)]; };
  std::string where = time_of(*worst, *misfit, data.target);
  where += worst->rollout ? " of rollout " + at(data.target.rollouts, *worst->rollout).name
                          : " of every rollout";
  if (worst->channel) where += ", in " + at(data.target.state_channels, *worst->channel).label;
  return fmt::format(
      ". Your simulator is wrong{}: error {:.2g} times the noise there, {:.2g} times elsewhere",
      where, worst->there, worst->elsewhere);
}

}  // namespace npdr::pipeline
