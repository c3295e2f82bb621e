/// Recorded rollouts against what the simulator predicts under a posterior.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.h"
#include "analysis/quantiles.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::analysis {

/// Prediction of one method: quantile_bands() of the rollouts that its samples give.
struct Prediction {
  std::string name;  ///< such as "NPDR (MAF)"
  Bands bands;       ///< for all rollouts and channels of the target
};

struct TrajectoryPlot {
  std::string name;  ///< of the files: letters, digits, '_' and '-'
  std::vector<Prediction> predictions =
      {};                            ///< blue, orange, purple, ...; the first is drawn on top
  Index store_every = 1;             ///< the simulator kept every k-th state
  std::vector<Index> rollouts = {};  ///< to show, at most 6; empty: the first 6
  std::vector<Index> channels = {};  ///< to show, at most 12; empty: the first 12
  Index max_points = 500;            ///< along a curve; longer series are drawn at a stride
};

/// Draws a panel per channel (rows) and rollout (columns): the recorded series in black, and each
/// method's median on its band. Every row has one range of values: that of the recorded series, and
/// what medians add to it within three times its size and bands within one on either side. Throws
/// InputError for more methods than there are colors, or rollouts and channels that don't exist or
/// are too many; ShapeError for bands of another shape than the target.
Figure figure_of(const TrajectoryPlot& plot, const Target& target);

}  // namespace npdr::analysis
