#include "pipeline/import/glitch_report.h"

#include <fmt/format.h>

#include "pipeline/import/angle_wraps.h"
#include "pipeline/import/glitches.h"
#include "pipeline/import/rate_pairs.h"

namespace npdr::pipeline {
namespace {

std::string remedy_of_glitches(const CsvRows& rows, const CsvOptions& options) {
  if (rows.time.empty()) return "put its value right";
  return options.resample ? "leave its row out" : "leave its row out and add --resample DT";
}

// Samples before t, and it, that are the same.
Index num_still(const Vector& values, Index t) {
  Index count = 1;
  while (count <= t && values(t - count) == values(t)) ++count;
  return count;
}

// "": it doesn't leap.
std::string words_of_leap(const Channel& channel, const Vector& position, double dt) {
  constexpr Index at_rest = 5;  // fewer may be an encoder's, which goes slowly
  const std::vector<Index> lone = find_lone_steps(position);
  if (lone.empty() || !find_jumps(position, channel.unit).rows.empty()) return "";
  const Index t = lone.front(), still = num_still(position, t);
  return fmt::format(
      "{} leaps by {:.3g} in the step after {:.6g} s{}{}, several times further than elsewhere: "
      "{}? Unless it does move like that, put these rows right, or cut the rollout there",
      channel.label, position(t + 1) - position(t), static_cast<double>(t) * dt,
      still >= at_rest ? fmt::format(", after {} samples that are the same", still) : "",
      lone.size() > 1 ? fmt::format(" (and {} times more)", lone.size() - 1) : "",
      still >= at_rest ? "did the sensor stand still" : "are samples missing, or wrong");
}

}  // namespace

Findings find_glitches(const std::vector<CsvRows>& files, const CsvOptions& options) {
  Findings found;
  for (const CsvRows& rows : files) {
    for (std::size_t c = 0; c < rows.states.size(); ++c) {
      const Vector values = rows.state_values.col(static_cast<Index>(c));
      const std::vector<Index> glitches = find_glitches(values);
      if (glitches.empty()) continue;
      const Index t = glitches.front();
      const std::string others =
          glitches.size() > 1 ? fmt::format(", and {} more", glitches.size() - 1) : "";
      found.push_back(warning(fmt::format(
          "{}:{}: {} = {:.6g} alone, between {:.4g} and {:.4g}{}: a glitch of the sensor? Noise "
          "and errors count as shares of the channel's largest magnitude: {}",
          rows.name, t + 2, rows.states[c].label, values(t), values(t - 1), values(t + 1), others,
          remedy_of_glitches(rows, options))));
    }
  }
  return found;
}

Findings find_leaps(const Target& recording, const std::vector<std::string>& names) {
  Findings found;
  for (const Index c : positions_of(recording.state_channels)) {
    for (std::size_t h = 0; h < names.size(); ++h) {
      const std::string of_rollout =
          words_of_leap(recording.state_channels[static_cast<std::size_t>(c)],
                        recording.rollouts[h].states.col(c), recording.dt);
      if (of_rollout.empty()) continue;
      found.push_back(warning(names[h] + ": " + of_rollout));
      break;
    }
  }
  return found;
}

}  // namespace npdr::pipeline
