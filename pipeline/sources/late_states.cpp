#include "pipeline/sources/late_states.h"

#include <algorithm>

#include "analysis/begins_at_rest.h"

namespace npdr::pipeline {
namespace {

bool begins_late(const sim::Trajectories& x, Index row, const Target& recorded) {
  for (Index h = 0; h < x.num_rollouts; ++h) {
    const RowMatrix& states = recorded.rollouts[static_cast<std::size_t>(h)].states;
    if (x.rollout(row, h).row(0) != states.row(0).cast<float>()) return false;
  }
  return true;
}

}  // namespace

std::string late_states(const sim::Trajectories& x, const Target& recorded) {
  if (std::ranges::any_of(recorded.rollouts, analysis::begins_at_rest)) return "";
  Index num_good = 0;
  for (Index i = 0; i < x.num_rows; ++i) {
    if (x.status[static_cast<std::size_t>(i)] != sim::RolloutStatus::ok) continue;
    if (!begins_late(x, i, recorded)) return "";
    ++num_good;
  }
  if (num_good == 0) return "";
  return "every rollout begins with the very state that it was given: wanted are the states after "
         "each action; where the given one is the first of them, all come a step late";
}

}  // namespace npdr::pipeline
