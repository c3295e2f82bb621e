#include "pipeline/artefacts/rollout_length.h"

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
        "{}: has {} rows, the first file has {}; to cut the longer ones, add --length shortest or "
        "--length STEPS",
        files[h], num_steps + 1, target.num_steps() + 1));
  }
}

Index shortest_of(const Target& target) {
  Index shortest = target.num_steps();
  for (const Rollout& rollout : target.rollouts) {
    shortest = std::min(shortest, rollout.num_steps());
  }
  return shortest;
}

void cut(Rollout& rollout, Index num_steps) {
  rollout.states.conservativeResize(num_steps + 1, Eigen::NoChange);
  rollout.actions.conservativeResize(num_steps, Eigen::NoChange);
}

}  // namespace

std::vector<std::string> cut_rollouts(Target& target, const std::optional<Index>& length,
                                      const std::vector<std::string>& files) {
  if (!length) {
    require_equal_lengths(target, files);
    return {};
  }
  const Index num_steps = *length == 0 ? shortest_of(target) : *length;
  std::vector<std::string> losses;
  for (std::size_t h = 0; h < files.size(); ++h) {
    Rollout& rollout = target.rollouts[h];
    const Index loss = rollout.num_steps() - num_steps;
    if (loss < 0) {
      throw InputError(fmt::format("--length {}: {} has {}, must have at least as many", num_steps,
                                   files[h], counted(rollout.num_steps(), "step")));
    }
    losses.push_back(fmt::format("{} {}", rollout.name, loss));
    cut(rollout, num_steps);
  }
  return {fmt::format("cut to {}; steps that are dropped: {}", counted(num_steps, "step"),
                      join(losses))};
}

}  // namespace npdr::pipeline
