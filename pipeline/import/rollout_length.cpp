#include "pipeline/import/rollout_length.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

void require_equal_lengths(const Target& target, const std::vector<std::string>& files) {
  for (std::size_t h = 0; h < files.size(); ++h) {
    const Index num_steps = target.rollouts[h].num_steps();
    if (num_steps == target.num_steps()) continue;
    throw InputError(fmt::format(
        "{}: has {} rows {:.6g} s apart, the first file has {}; to cut them to one length, add "
        "--length shortest or --length STEPS",
        files[h], num_steps + 1, target.dt, target.num_steps() + 1));
  }
}

Index shortest_of(const Target& target) {
  Index shortest = target.num_steps();
  for (const Rollout& rollout : target.rollouts) {
    shortest = std::min(shortest, rollout.num_steps());
  }
  return shortest;
}

Rollout piece(const Rollout& rollout, Index number, Index num_steps) {
  const Index begin = number * num_steps;
  return {fmt::format("{}.{}", rollout.name, number + 1),
          rollout.states.middleRows(begin, num_steps + 1),
          rollout.actions.middleRows(begin, num_steps)};
}

}  // namespace

Findings cut_rollouts(Target& target, const std::optional<Index>& length,
                      const std::vector<std::string>& files) {
  if (!length) {
    require_equal_lengths(target, files);
    return {};
  }
  const Index num_steps = *length == 0 ? shortest_of(target) : *length;
  std::vector<std::string> origins;
  std::vector<Rollout> pieces;
  for (std::size_t h = 0; h < files.size(); ++h) {
    const Rollout& rollout = target.rollouts[h];
    const Index count = rollout.num_steps() / num_steps;
    if (count == 0) {
      throw InputError(fmt::format("--length {}: {} has {}, must have at least as many", num_steps,
                                   files[h], counted(rollout.num_steps(), "step")));
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
