#include "pipeline/import/recording_warnings.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/import/angle_wraps.h"
#include "pipeline/import/glitch_report.h"
#include "pipeline/import/rate_pairs.h"
#include "pipeline/import/rate_report.h"
#include "pipeline/import/rollout_copies.h"
#include "sim/savitzky_golay.h"

namespace npdr::pipeline {
namespace {

std::vector<std::string> names_of_rollouts(const Target& recording) {
  std::vector<std::string> names;
  for (const Rollout& rollout : recording.rollouts) names.push_back("rollout " + rollout.name);
  return names;
}

// Of the first rollout that has any; "": none.
std::string words_of_jumps(const Target& recording, Index c) {
  const auto& [label, unit] = recording.state_channels[static_cast<std::size_t>(c)];
  for (const Rollout& rollout : recording.rollouts) {
    const Vector angle = rollout.states.col(c);
    const AngleJumps jumps = find_jumps(angle, unit);
    if (jumps.rows.empty()) continue;
    const Index t = jumps.rows.front();
    return fmt::format(
        "{} jumps by {:.4g} after state {} of rollout {}, a whole turn: it wraps; unwrap it", label,
        angle(t + 1) - angle(t), t, rollout.name);
  }
  return "";
}

// As --differentiate makes it: over windows so wide that it may look wrong.
bool is_computed(const Rollout& rollout, const RatePair& pair, double dt) {
  constexpr Index widest = 201, enough = 1000;
  const Index m = std::min(rollout.states.rows(), enough);
  const Vector position = rollout.states.col(pair.position).head(m);
  const Vector rate = rollout.states.col(pair.rate).head(m);
  const double rounding = 1e-9 * rate.cwiseAbs().maxCoeff();
  for (Index window = 5; window <= std::min(m, widest); window += 2) {
    // Within half a window of an end, the rollout may have been cut there since.
    const Vector errors = sim::slopes(position, window, dt) - rate;
    if (errors.segment(window / 2, m - window + 1).cwiseAbs().maxCoeff() <= rounding) return true;
  }
  return false;
}

std::vector<RatePair> measured_pairs(const Target& recording) {
  std::vector<RatePair> pairs = rate_pairs(recording.state_channels);
  std::ranges::copy(likely_rate_pairs(recording.state_channels), std::back_inserter(pairs));
  std::erase_if(pairs, [&](const RatePair& pair) {
    return is_computed(recording.rollouts.front(), pair, recording.dt);
  });
  return pairs;
}

}  // namespace

std::vector<std::string> recording_warnings(const Target& recording) {
  std::vector<std::string> warnings;
  for (Index c = 0; c < recording.num_states(); ++c) {
    std::string jumps = words_of_jumps(recording, c);
    if (!jumps.empty()) warnings.push_back(std::move(jumps));
  }
  const std::vector<std::string> names = names_of_rollouts(recording);
  std::ranges::move(words_of_leaps(recording, names), std::back_inserter(warnings));
  const RateReport report = report_rates(recording, measured_pairs(recording), names, "");
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
