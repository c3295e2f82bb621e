/// Quantiles over samples of trajectories, pointwise.
#pragma once

#include <vector>

#include "analysis/trajectory_view.h"
#include "core/types.h"

namespace npdr::analysis {

/// Predictive median and a band around it, pointwise in time: entry h is rollout h, (T, C), in the
/// unit of the trajectories.
struct Bands {
  std::vector<RowMatrix> lower;
  std::vector<RowMatrix> median;
  std::vector<RowMatrix> upper;
  double coverage = 0.9;  ///< share of the samples between lower and upper
  Index num_samples = 0;  ///< that the quantiles are over: those whose rollouts didn't fail
};

/// Quantiles (1 - coverage) / 2, 1/2 and (1 + coverage) / 2 over samples. Samples with a value that
/// isn't finite are left out; NaN throughout when none is left. Parallel, with the same bits for
/// any number of threads. Throws ShapeError as TrajectoryView::check(), InputError for a coverage
/// outside (0, 1).
Bands quantile_bands(const TrajectoryView& simulated, double coverage = 0.9);

}  // namespace npdr::analysis
