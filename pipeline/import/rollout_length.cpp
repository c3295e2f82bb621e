#include "pipeline/import/rollout_length.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

Index shortest_of(const Target& target) {
  return std::ranges::min(target.rollouts, {}, &Rollout::num_steps).num_steps();
}

void require_equal_lengths(const Target& target) {
  for (const Rollout& rollout : target.rollouts) {
    if (rollout.num_steps() == target.num_steps()) continue;
    throw InputError(fmt::format(
        "rollout {} has {} of {:.6g} s, the first one has {}; to cut them to one length, add "
        "--length shortest or --length STEPS",
        rollout.name, counted(rollout.num_steps(), "step"), target.dt, target.num_steps()));
  }
}

Rollout piece(const Rollout& rollout, Index number, Index num_steps) {
  const Index begin = number * num_steps;
  return {fmt::format("{}.{}", rollout.name, number + 1),
          rollout.states.middleRows(begin, num_steps + 1),
          rollout.actions.middleRows(begin, num_steps)};
}

}  // namespace

Findings cut_rollouts(Target& target, const std::optional<Index>& length) {
  if (!length) {
    require_equal_lengths(target);
    return {};
  }
  const Index num_steps = *length == 0 ? shortest_of(target) : *length;
  std::vector<std::string> origins;
  std::vector<Rollout> pieces;
  for (const Rollout& rollout : target.rollouts) {
    const Index count = rollout.num_steps() / num_steps;
    if (count == 0) {
      throw InputError(fmt::format("--length {}: rollout {} has {}, must have at least as many",
                                   num_steps, rollout.name, counted(rollout.num_steps(), "step")));
    }
    for (Index k = 0; k < count; ++k) pieces.push_back(piece(rollout, k, num_steps));
    if (count == 1) pieces.back().name = rollout.name;
    origins.push_back(fmt::format("{} of {} ({} dropped)", count, rollout.name,
                                  counted(rollout.num_steps() - count * num_steps, "step")));
  }
  target.rollouts = std::move(pieces);
  return {
      note(fmt::format("cut into rollouts of {}: {}", counted(num_steps, "step"), join(origins)))};
}

}  // namespace npdr::pipeline
