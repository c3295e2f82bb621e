#include "pipeline/import/recording_warnings.h"

#include <fmt/format.h>

#include "pipeline/import/angle_wraps.h"
#include "pipeline/import/rate_pairs.h"
#include "pipeline/import/rate_report.h"
#include "pipeline/import/rollout_copies.h"

namespace npdr::pipeline {
namespace {

std::vector<std::string> names_of_rollouts(const Target& recording) {
  std::vector<std::string> names;
  for (const Rollout& rollout : recording.rollouts) names.push_back("rollout " + rollout.name);
  return names;
}

// Of the first rollout that has any; "": none.
std::string words_of_jumps(const Target& recording, std::size_t c) {
  const auto& [label, unit] = recording.state_channels[c];
  for (const Rollout& rollout : recording.rollouts) {
    const Vector angle = rollout.states.col(static_cast<Index>(c));
    const AngleJumps jumps = find_jumps(angle, unit);
    if (jumps.rows.empty()) continue;
    const Index t = jumps.rows.front();
    return fmt::format(
        "{} jumps by {:.4g} after state {} of rollout {}, a whole turn: it wraps; add turns to "
        "what "
        "follows, so that it goes on",
        label, angle(t + 1) - angle(t), t, rollout.name);
  }
  return "";
}

}  // namespace

std::vector<std::string> recording_warnings(const Target& recording) {
  std::vector<std::string> warnings;
  for (std::size_t c = 0; c < recording.state_channels.size(); ++c) {
    std::string jumps = words_of_jumps(recording, c);
    if (!jumps.empty()) warnings.push_back(std::move(jumps));
  }
  const RateReport report = report_rates(recording, rate_pairs(recording.state_channels),
                                         names_of_rollouts(recording), "");
  for (const std::string& problem : report.problems) {
    const bool names_option = problem.find("--") != std::string::npos;
    warnings.push_back(
        problem + (names_option ? " (to npdr import; in an HDF5 file, correct the numbers)" : ""));
  }
  for (const auto& [one, other] : copies_of(recording)) {
    warnings.push_back(fmt::format(
        "rollout {} holds the same numbers as {}, and counts twice; target.rollouts leaves it out",
        recording.rollouts[other].name, recording.rollouts[one].name));
  }
  return warnings;
}

}  // namespace npdr::pipeline
