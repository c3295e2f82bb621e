#include "analysis/trajectory_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace npdr::analysis {

Eigen::Map<const RowMatrixF> TrajectoryView::rollout(Index i, Index h) const {
  return {values.data() + i * row_size() + h * num_steps * num_states, num_steps, num_states};
}

bool TrajectoryView::finite(Index i) const {
  const auto row = values.subspan(static_cast<std::size_t>(i * row_size()),
                                  static_cast<std::size_t>(row_size()));
  return std::all_of(row.begin(), row.end(), [](float v) { return std::isfinite(v); });
}

std::vector<Index> TrajectoryView::finite_samples() const {
  std::vector<Index> samples;
  for (Index i = 0; i < num_samples; ++i) {
    if (finite(i)) samples.push_back(i);
  }
  return samples;
}

void TrajectoryView::check() const {
  if (num_samples >= 0 && num_rollouts > 0 && num_steps > 0 && num_states > 0 &&
      num_samples * row_size() == static_cast<Index>(values.size())) {
    return;
  }
  throw ShapeError(fmt::format("{} trajectory values aren't ({}, {}, {}, {})", values.size(),
                               num_samples, num_rollouts, num_steps, num_states));
}

}  // namespace npdr::analysis
