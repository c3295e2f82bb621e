#include "pipeline/import/recording_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "pipeline/import/jumps.h"
#include "pipeline/import/rate_check.h"
#include "sim/savitzky_golay.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kOfOptions = " (to npdr import; in an HDF5 file, correct the numbers)";

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
  append(pairs, likely_rate_pairs(recording.state_channels));
  std::erase_if(pairs, [&](const RatePair& pair) {
    return is_computed(recording.rollouts.front(), pair, recording.dt);
  });
  return pairs;
}

Findings find_wrapped_angles(const Target& recording) {
  Findings found = find_turns(recording);
  for (Finding& problem : found) problem.what += kOfOptions;
  return found;
}

Findings find_wrong_rates(const Target& recording) {
  Findings found = find_in_rates(recording, measured_pairs(recording), "", kOfOptions);
  std::erase_if(found, [](const Finding& f) { return f.severity == Severity::note; });
  return found;
}

Findings find_copies(const Target& recording) {
  Findings found;
  for (const auto& [one, other] : copies_of(recording)) {
    found.push_back(warning(fmt::format(
        "{} holds the same numbers as {}, and counts twice; target.rollouts leaves it out",
        recording.rollouts[other].name, recording.rollouts[one].name)));
  }
  return found;
}

constexpr std::array<Probe<Target>, 4> kProbes = {{
    {"wrapped_angle", find_wrapped_angles},
    {"leap", find_leaps},
    {"wrong_rate", find_wrong_rates},
    {"rollout_twice", find_copies},
}};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> copies_of(const Target& recording) {
  std::vector<std::pair<std::size_t, std::size_t>> copies;
  for (std::size_t j = 1; j < recording.rollouts.size(); ++j) {
    const Rollout& other = recording.rollouts[j];
    const auto one = std::ranges::find_if(recording.rollouts, [&](const Rollout& rollout) {
      return &rollout == &other ||
             (rollout.states.rows() == other.states.rows() && rollout.states == other.states &&
              rollout.actions == other.actions);
    });
    const auto i = static_cast<std::size_t>(one - recording.rollouts.begin());
    if (i < j) copies.emplace_back(i, j);
  }
  return copies;
}

Findings warnings_of(Target recording) {
  for (Rollout& rollout : recording.rollouts) rollout.name = "rollout " + rollout.name;
  return find_by(kProbes, recording);
}

}  // namespace npdr::pipeline
