#include "pipeline/import/glitches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/constants.h"
#include "pipeline/import/angle_wraps.h"
#include "pipeline/import/rate_pairs.h"

namespace npdr::pipeline {
namespace {

double usual_range(Vector values) {
  std::sort(values.begin(), values.end());
  const Index outer = std::max<Index>(values.size() / 100, 1);
  return values(values.size() - 1 - outer) - values(outer);
}

}  // namespace

std::vector<Index> find_glitches(const Vector& values) {
  constexpr Index fewest = 10;
  constexpr double far = 2.0, near = 0.25;
  std::vector<Index> glitches;
  if (values.size() < fewest) return glitches;
  const double range = usual_range(values);
  if (!(range > 0.0)) return glitches;
  for (Index t = 1; t + 1 < values.size(); ++t) {
    const double before = values(t - 1), after = values(t + 1);
    const double distance = std::abs(values(t) - 0.5 * (before + after));
    if (distance > far * range && std::abs(after - before) < near * distance) glitches.push_back(t);
  }
  return glitches;
}

std::vector<Index> find_lone_steps(const Vector& position) {
  constexpr Index fewest = 30;
  constexpr double larger = 4.0, share = 0.02;
  const Index n = position.size() - 1;
  if (n + 1 < fewest) return {};
  const Vector steps = position.tail(n) - position.head(n);
  Vector sorted = steps.cwiseAbs();
  std::sort(sorted.begin(), sorted.end(), std::greater());
  double least = kInfinity;
  for (Index k = 1; k <= std::max<Index>(n / 100, 3); ++k) {
    if (sorted(k) > 0.0 && sorted(k - 1) > larger * sorted(k)) least = sorted(k - 1);
  }
  least = std::max(least, share * (position.maxCoeff() - position.minCoeff()));
  // Several steps on end in one direction are a short motion.
  const auto goes_on = [&](Index t, Index beside) {
    return beside >= 0 && beside < n && larger * steps(beside) / steps(t) > 1.0;
  };
  std::vector<Index> lone;
  for (Index t = 0; t < n; ++t) {
    const bool is_large = std::abs(steps(t)) >= least;
    if (is_large && !goes_on(t, t - 1) && !goes_on(t, t + 1)) lone.push_back(t);
  }
  return lone;
}

Findings find_glitches(const Target& recording) {
  Findings found;
  for (const Rollout& rollout : recording.rollouts) {
    for (Index c = 0; c < recording.num_states(); ++c) {
      const Vector values = rollout.states.col(c);
      const std::vector<Index> glitches = find_glitches(values);
      if (glitches.empty()) continue;
      const Index t = glitches.front();
      found.push_back(warning(fmt::format(
          "{}: {} = {:.6g} in row {} alone, between {:.4g} and {:.4g}{}: a glitch of the sensor? "
          "It sets the channel's magnitude, of which noise and errors are shares; correct it, or "
          "leave its row out and add --resample DT",
          rollout.name, recording.state_channels[static_cast<std::size_t>(c)].label, values(t),
          t + 1, values(t - 1), values(t + 1),
          glitches.size() > 1 ? fmt::format(", and {} more", glitches.size() - 1) : "")));
    }
  }
  return found;
}

Findings find_leaps(const Target& recording) {
  Findings found;
  for (const Index c : positions_of(recording.state_channels)) {
    const auto& [label, unit] = recording.state_channels[static_cast<std::size_t>(c)];
    for (const Rollout& rollout : recording.rollouts) {
      const Vector position = rollout.states.col(c);
      const std::vector<Index> lone = find_lone_steps(position);
      if (lone.empty() || !find_jumps(position, unit).rows.empty()) continue;
      found.push_back(warning(rollout.name + ": " +
                              words_of_leaps(label, position, lone, recording.dt,
                                             "several times further than elsewhere") +
                              "; nothing is wrong if it does move like that"));
      break;
    }
  }
  return found;
}

std::string words_of_leaps(const std::string& label, const Vector& position,
                           const std::vector<Index>& steps, double dt, const std::string& reason) {
  const Index t = steps.front();
  return fmt::format(
      "{} leaps by {:.3g} in the step after {:.6g} s{}, {}: samples are missing or wrong, the "
      "sensor stood still, or it wraps there; correct these rows, or cut the rollout there",
      label, position(t + 1) - position(t), static_cast<double>(t) * dt,
      steps.size() > 1 ? fmt::format(" (and {} times more)", steps.size() - 1) : "", reason);
}

}  // namespace npdr::pipeline
