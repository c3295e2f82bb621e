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

// Times the noise, with three digits where it is near a limit.
std::string size_text(double times) {
  return times < 10.0 ? fmt::format("{:.3g}", times) : short_number(times);
}

std::string evidence_of(const RecordingMisfit& m) {
  return fmt::format("the best parameters leave errors of {} times the {} (fine up to {:.3g})",
                     size_text(m.times),
                     m.noise_is_given ? "stated noise" : "scatter of neighboring samples", m.limit);
}

}  // namespace

std::string short_number(double value) {
  return value < 10.0 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

std::optional<Finding> words_of_cause(const ReportData& data) {
  // About as good as a right simulator, or most of the rest taken away.
  constexpr double most_of_rest = 0.25;
  const auto& m = data.baseline.misfit;
  if (!m || !m->is_beyond() || m->cause.empty() ||
      !(m->times_of_cause <= std::max(kMostOfGivenNoise, 1.0 + most_of_rest * (m->times - 1.0)))) {
    return std::nullopt;
  }
  return Finding{.id = "cause",
                 .what = "it looks as if " + m->cause,
                 .evidence = evidence_of(*m) +
                             fmt::format("; with {}, {}", m->change, size_text(m->times_of_cause)),
                 .advice = "Correct the recording, the prior or the simulator"};
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
  return {.id = "misfit",
          .what = "your simulator does not explain the recording" + where,
          .evidence = evidence_of(m),
          .advice = m.noise_is_given
                        ? "Look for friction, a delay, a wrong clock or too small a stated noise"
                        : "Look for friction, a delay or a wrong clock"};
}

}  // namespace npdr::pipeline
