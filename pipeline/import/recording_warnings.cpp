#include "pipeline/import/recording_warnings.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/import/angle_wraps.h"
#include "pipeline/import/glitch_report.h"
#include "pipeline/import/rate_pairs.h"
#include "pipeline/import/rate_report.h"
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

bool is_copy(const Rollout& one, const Rollout& other) {
  return one.states.rows() == other.states.rows() && one.states == other.states &&
         one.actions == other.actions;
}

Findings find_jumps_of_turns(const Target& recording) {
  Findings found;
  for (Index c = 0; c < recording.num_states(); ++c) {
    if (std::string jumps = words_of_jumps(recording, c); !jumps.empty()) {
      found.push_back(warning(std::move(jumps)));
    }
  }
  return found;
}

Findings find_wrong_rates(const Target& recording) {
  Findings found =
      find_in_rates(recording, measured_pairs(recording), names_of_rollouts(recording), "");
  std::erase_if(found, [](const Finding& f) { return f.severity == Severity::note; });
  for (Finding& problem : found) {
    const bool names_option = problem.what.find("--") != std::string::npos;
    problem.what += names_option ? " (to npdr import; in an HDF5 file, correct the numbers)" : "";
  }
  return found;
}

Findings find_copies(const Target& recording) {
  Findings found;
  for (const auto& [one, other] : copies_of(recording)) {
    found.push_back(warning(fmt::format(
        "rollout {} holds the same numbers as {}, and counts twice; target.rollouts leaves it out",
        recording.rollouts[other].name, recording.rollouts[one].name)));
  }
  return found;
}

constexpr std::array<Probe<Target>, 4> kProbes = {{
    {"wrapped_angle", find_jumps_of_turns},
    {"leap", [](const Target& target) { return find_leaps(target, names_of_rollouts(target)); }},
    {"wrong_rate", find_wrong_rates},
    {"rollout_twice", find_copies},
}};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> copies_of(const Target& recording) {
  std::vector<std::pair<std::size_t, std::size_t>> copies;
  for (std::size_t j = 1; j < recording.rollouts.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (!is_copy(recording.rollouts[i], recording.rollouts[j])) continue;
      copies.emplace_back(i, j);
      break;
    }
  }
  return copies;
}

Findings warnings_of(const Target& recording) { return find_by(kProbes, recording); }

}  // namespace npdr::pipeline
