#include "pipeline/import/jumps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/constants.h"
#include "core/error.h"
#include "core/quantile.h"
#include "core/text.h"
#include "pipeline/import/rates.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

constexpr double kDegrees = 360.0;
constexpr double kRadians = 2.0 * std::numbers::pi;
constexpr Index kNeighbors = 2;  // steps on each side that say how fast the angle moves

// A whole turn; none in other units.
std::optional<double> turn_in(const std::string& unit) {
  if (unit == "rad") return kRadians;
  if (unit == "deg") return kDegrees;
  return std::nullopt;
}

// The steps around step t, without t itself.
std::vector<double> steps_around(const Vector& steps, Index t, Index neighbors = kNeighbors) {
  std::vector<double> around;
  const Index last = std::min(t + neighbors, steps.size() - 1);
  for (Index i = std::max<Index>(t - neighbors, 0); i <= last; ++i) {
    if (i != t) around.push_back(steps(i));
  }
  return around;
}

double median_of(std::vector<double> values) {
  return values.empty() ? 0.0 : upper_median(std::move(values));
}

double mean_of(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Jumps of one turn: what is left of them without it goes on as the steps around them do. Other
// jumps, such as to a number that says that none was measured, are no turns.
std::vector<Index> jumps_of(const Vector& angle, double period) {
  const Vector steps = differences(angle);
  const Vector rest = steps.unaryExpr([&](double d) { return std::remainder(d, period); });
  const double quarter = 0.25 * period;
  std::vector<Index> rows;
  for (Index t = 0; t < steps.size(); ++t) {
    const double size = std::abs(steps(t));
    if (size < 0.5 * period || size > 1.25 * period || std::abs(rest(t)) > quarter) continue;
    const double around = median_of(steps_around(rest, t));
    if (std::abs(around) > quarter) continue;
    if (std::abs(rest(t) - around) > 0.15 * period) continue;
    // Who turns that fast all the time does turn. Noise at the end of a turn goes to and fro.
    const bool goes_on = std::abs(steps(t) - mean_of(steps_around(steps, t))) < 0.5 * period;
    if (!goes_on) rows.push_back(t);
  }
  return rows;
}

double usual_range(Vector values) {
  std::sort(values.begin(), values.end());
  const Index outer = std::max<Index>(values.size() / 100, 1);
  return values(values.size() - 1 - outer) - values(outer);
}

}  // namespace

AngleJumps find_jumps(const Vector& angle, const std::string& unit) {
  const std::optional<double> turn = turn_in(unit);
  if (!turn || angle.size() < 2) return {};
  if (unit == "rad" && angle.cwiseAbs().maxCoeff() <= 1.01 * kDegrees) {
    AngleJumps degrees = {kDegrees, jumps_of(angle, kDegrees)};
    if (!degrees.rows.empty()) return degrees;
  }
  return {*turn, jumps_of(angle, *turn)};
}

Index count_spikes(const Vector& rate, double dt, const std::string& unit) {
  const std::optional<double> turn = turn_in(unit);
  if (!turn) return 0;
  const Vector turns = rate.cwiseAbs() * (dt / *turn);  // in a step
  Index count = 0;
  for (Index t = 0; t < turns.size(); ++t) {
    const bool is_whole = std::abs(turns(t) - 1.0) < 0.15, is_half = std::abs(turns(t) - 0.5) < 0.1;
    if (!is_whole && !is_half) continue;
    count += median_of(steps_around(turns, t, kNeighbors + 1)) < 0.1;
  }
  return count;
}

Index unwrap(Eigen::Ref<Vector, 0, Eigen::InnerStride<>> angle, double period) {
  Index count = 0;
  double turns = 0.0;
  for (Index t = 1; t < angle.size(); ++t) {
    const double step = angle(t) + turns * period - angle(t - 1);
    const double whole = std::round(step / period);
    turns -= whole;
    count += whole != 0.0;
    angle(t) += turns * period;
  }
  return count;
}

Findings find_turns(const Target& recording) {
  Findings found;
  for (Index c = 0; c < recording.num_states(); ++c) {
    const auto& [label, unit] = recording.state_channels[static_cast<std::size_t>(c)];
    std::string first;
    bool are_degrees = false;
    Index num_jumps = 0, num_rollouts = 0;
    for (const Rollout& rollout : recording.rollouts) {
      const Vector angle = rollout.states.col(c);
      const auto [period, rows] = find_jumps(angle, unit);
      if (rows.empty()) continue;
      if (num_jumps == 0) {
        const Index t = rows.front();
        first = fmt::format("{}: {} jumps by {:.4g} after row {}", rollout.name, label,
                            angle(t + 1) - angle(t), t + 1);
        are_degrees = unit == "rad" && period == kDegrees;
      }
      num_jumps += std::ssize(rows);
      ++num_rollouts;
    }
    if (num_jumps == 0) continue;
    found.push_back(warning(
        fmt::format("{} ({} in {}), a whole turn{}: it wraps; add {}--unwrap {}", first,
                    counted(num_jumps, "such jump"), counted(num_rollouts, "rollout"),
                    are_degrees ? " of degrees, though its unit says [rad]" : "",
                    are_degrees ? fmt::format("--scale {}=0.0174533 ", label) : "", label)));
  }
  return found;
}

Findings unwrap_turns(Target& recording, const std::vector<std::string>& labels) {
  Findings found;
  for (const std::string& label : labels) {
    const std::vector<Channel>& states = recording.state_channels;
    const auto state = std::ranges::find(states, label, &Channel::label);
    if (state == states.end()) {
      throw InputError("--unwrap: " + unknown_name("state", label, labels_of(states)));
    }
    const std::string& unit = state->unit;
    const std::optional<double> turn = turn_in(unit);
    if (!turn) {
      throw InputError(
          fmt::format("--unwrap {}: it is in [{}], must be in [rad] or [deg]", label, unit));
    }
    Index count = 0;
    for (Rollout& rollout : recording.rollouts) {
      count += unwrap(rollout.states.col(state - states.begin()), *turn);
    }
    found.push_back(note(
        fmt::format("unwrapped {}: {} of a whole turn taken out", label, counted(count, "jump"))));
  }
  return found;
}

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
  const Vector steps = differences(position);
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
