// Whether, where and why a simulator doesn't explain a recording.
#include <fmt/format.h>

#include <algorithm>

#include "pipeline/findings/probe.h"
#include "pipeline/predictions/misfit.h"

namespace npdr::pipeline {
namespace {

// " in the first 0.6 s", " from 1.2 s on", " between 1.2 and 1.8 s"; "": all the time.
std::string time_of(const analysis::Concentration& worst, const RecordingMisfit& misfit,
                    const Target& target) {
  const Index parts = misfit.left.rows() / misfit.num_rollouts;
  const double part =
      target.dt * static_cast<double>(target.num_steps()) / static_cast<double>(parts);
  const double begin = part * static_cast<double>(worst.begin);
  const double end = part * static_cast<double>(worst.end);
  if (worst.begin == 0 && worst.end == parts) return "";
  if (worst.begin == 0) return fmt::format(" in the first {} s", short_number(end));
  if (worst.end == parts) return fmt::format(" from {} s on", short_number(begin));
  return fmt::format(" between {} and {} s", short_number(begin), short_number(end));
}

}  // namespace

std::string short_number(double value) {
  return value < 10.0 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

Finding words_of_misfit(const ReportData& data) {
  const RecordingMisfit& m = *data.baseline.misfit;
  std::string where;
  if (const auto worst = analysis::concentration(m)) {
    const auto at = [](const auto& items, Index i) { return items[static_cast<std::size_t>(i)]; };
    if (worst->channel) where += " in " + at(data.target.state_channels, *worst->channel).label;
    where += worst->rollout ? " of rollout " + at(data.target.rollouts, *worst->rollout).name
                            : " of every rollout";
    where += time_of(*worst, m, data.target);
  }
  Finding said = {
      .id = "misfit",
      .what = "your simulator does not explain the recording" + where,
      .evidence = fmt::format(
          "the best parameters leave {} times the {} (fine up to {:.3g})",
          m.times < 10.0 ? fmt::format("{:.3g}", m.times) : short_number(m.times),
          m.noise_is_given ? "stated noise" : "scatter of neighboring samples", m.limit),
      .advice = "Look for friction, a delay or a wrong clock"};
  // What is about as good as a right simulator, or takes away most of the rest.
  constexpr double most_of_rest = 0.25;
  if (!m.cause.empty() &&
      m.times_of_cause < std::max(kMostOfGivenNoise, 1.0 + most_of_rest * (m.times - 1.0))) {
    said.advice =
        fmt::format("Try {}, which would leave {} times", m.cause, short_number(m.times_of_cause));
  }
  return said;
}

}  // namespace npdr::pipeline
