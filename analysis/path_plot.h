/// Paths on a plane seen from above: recorded ones, and what posterior samples predict, among
/// shapes that may depend on the parameters.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.h"
#include "core/outline.h"
#include "core/types.h"

namespace npdr::analysis {

/// Prediction of one method.
struct PathPrediction {
  std::string name;                 ///< such as "NPDR (MAF)"
  std::vector<RowMatrix> paths;     ///< (T, 2) each: one per sample and rollout
  std::vector<RowMatrix> outlines;  ///< (k, 2) each: polygons at the samples
};

struct PathPlot {
  std::string name;        ///< of the files: letters, digits, '_' and '-'
  std::string unit = "m";  ///< of both axes
  std::vector<PathPrediction> predictions;
  std::vector<RowMatrix> fixed;     ///< polygons that no parameter moves
  std::vector<RowMatrix> recorded;  ///< (T + 1, 2) paths that inference saw
  std::vector<RowMatrix> held_out;  ///< (T + 1, 2) paths that it didn't see
};

/// Draws one panel per method, of equal scale in x and y, that shows the fixed polygons and a
/// margin. Throws InputError for no or too many methods, or no fixed polygon; ShapeError for points
/// that aren't (k, 2), k >= 1.
Figure figure_of(const PathPlot& plot);

}  // namespace npdr::analysis
