#include "analysis/begins_at_rest.h"

#include <algorithm>

namespace npdr::analysis {

bool begins_at_rest(const Rollout& rollout) {
  const RowMatrixF states = rollout.states.cast<float>();
  if (states.rows() < 2) return true;
  const RowMatrixF steps =
      (states.bottomRows(states.rows() - 1) - states.topRows(states.rows() - 1)).cwiseAbs();
  for (Index c = 0; c < steps.cols(); ++c) {
    VectorF sorted = steps.col(c);
    std::ranges::sort(sorted);
    const float usual = sorted(sorted.size() / 2);
    if (steps(0, c) > 0.0f && steps(0, c) >= 0.5f * usual) return false;
  }
  return true;
}

}  // namespace npdr::analysis
