#include "pipeline/sources/late_states.h"

#include <algorithm>

namespace npdr::pipeline {
namespace {

// Its first step is at least half of the usual one in some channel, as floats see it: not at rest.
bool moves_at_once(const Rollout& rollout) {
  const RowMatrixF states = rollout.states.cast<float>();
  if (states.rows() < 2) return false;
  const RowMatrixF steps =
      (states.bottomRows(states.rows() - 1) - states.topRows(states.rows() - 1)).cwiseAbs();
  for (Index c = 0; c < steps.cols(); ++c) {
    VectorF sorted = steps.col(c);
    std::ranges::sort(sorted);
    const float usual = sorted(sorted.size() / 2);
    if (steps(0, c) > 0.0f && steps(0, c) >= 0.5f * usual) return true;
  }
  return false;
}

bool begins_late(const sim::Trajectories& x, Index row, const Target& recorded) {
  for (Index h = 0; h < x.num_rollouts; ++h) {
    const RowMatrix& states = recorded.rollouts[static_cast<std::size_t>(h)].states;
    if (x.rollout(row, h).row(0) != states.row(0).cast<float>()) return false;
  }
  return true;
}

}  // namespace

std::string late_states(const sim::Trajectories& x, const Target& recorded) {
  if (!std::ranges::all_of(recorded.rollouts, moves_at_once)) return "";
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
