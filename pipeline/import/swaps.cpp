#include "pipeline/import/swaps.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/finding.h"
#include "pipeline/import/jumps.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostSamples = 5000;  // of a rollout: enough to tell a slope by

// Of column c, states first and actions behind them, those of all steps.
Vector column_of(const Target& target, const Rollout& rollout, Index c) {
  const Index num_states = target.num_states();
  const Index num_steps = std::min(rollout.num_steps(), kMostSamples);
  if (c >= num_states) return rollout.actions.col(c - num_states).head(num_steps);
  return unwrapped(target, rollout, c).head(num_steps);
}

std::optional<RateFit> fit_of(const Target& target, const Rollout& rollout, const RatePair& pair) {
  return fit_rate(column_of(target, rollout, pair.position), column_of(target, rollout, pair.rate),
                  target.dt);
}

// Whether a rate is the slope of its position in every rollout.
bool is_slope(const Target& target, const RatePair& pair) {
  return std::ranges::all_of(target.rollouts, [&](const Rollout& rollout) {
    const std::optional<RateFit> fit = fit_of(target, rollout, pair);
    return fit && agrees(fit);
  });
}

// The same, and far better than `other` may be in other units, or by another clock.
bool is_better_slope(const Target& target, const RatePair& pair, const RatePair& other) {
  constexpr double far_less = 0.3;
  const auto beats = [&](const Rollout& rollout) {
    const std::optional<RateFit> mine = fit_of(target, rollout, pair);
    const std::optional<RateFit> its = fit_of(target, rollout, other);
    return !its || verdict_of(*its) == RateVerdict::unrelated ||
           mine->scatter < far_less * its->scatter;
  };
  return is_slope(target, pair) && std::ranges::all_of(target.rollouts, beats);
}

// A column that is the slope of another, of which one belongs to a pair that doesn't agree. `free`:
// columns that no pair explains.
std::optional<RatePair> slope_beside(const Target& target, const RatePair& pair,
                                     const std::vector<Index>& free) {
  std::vector<RatePair> others;
  for (const Index c : free) {
    if (c == pair.position || c == pair.rate) continue;
    others.insert(others.end(),
                  {{pair.position, c}, {c, pair.rate}, {pair.rate, c}, {c, pair.position}});
  }
  const auto found = std::ranges::find_if(
      others, [&](const RatePair& p) { return is_better_slope(target, p, pair); });
  return found == others.end() ? std::nullopt : std::optional(*found);
}

}  // namespace

bool agrees(const std::optional<RateFit>& fit) {
  return !fit || verdict_of(*fit) == RateVerdict::agrees;
}

Vector unwrapped(const Target& target, const Rollout& rollout, Index c) {
  Vector values = rollout.states.col(c);
  const AngleJumps jumps =
      find_jumps(values, target.state_channels[static_cast<std::size_t>(c)].unit);
  if (!jumps.rows.empty()) unwrap(values, jumps.period);
  return values;
}

std::string words_of_swap(const Target& target, const RatePair& pair,
                          const std::vector<Index>& free) {
  std::vector<std::string> labels = labels_of(target.state_channels);
  append(labels, labels_of(target.action_channels));
  const auto label = [&](Index c) { return labels[static_cast<std::size_t>(c)]; };
  if (is_slope(target, {pair.rate, pair.position})) {
    return fmt::format("{} is the slope of {}: the two columns are swapped; correct the header",
                       label(pair.position), label(pair.rate));
  }
  const std::optional<RatePair> other = slope_beside(target, pair, free);
  if (!other) return "";
  const bool is_same = other->position == pair.position;
  return fmt::format(
      "{} isn't the slope of {}, but {} is{}: are columns swapped? Correct the header",
      label(pair.rate), label(pair.position), label(other->rate),
      is_same ? "" : " that of " + label(other->position));
}

}  // namespace npdr::pipeline
