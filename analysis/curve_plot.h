/// Figures of a quantity that changes from step to step, one curve a method: the mean over
/// experiments, and a band around it.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.h"
#include "core/types.h"

namespace npdr::analysis {

/// One method.
struct Curve {
  std::string method;
  Vector x;      ///< (k)
  Vector mean;   ///< (k)
  Vector lower;  ///< (k) of the band
  Vector upper;  ///< (k)
};

struct CurvePlot {
  std::string name;  ///< of the files: letters, digits, '_' and '-'
  std::string x_title;
  std::string y_title;
  std::vector<Curve> curves;
};

/// Mean and standard deviation over experiments, (k, experiments): the band is mean ± std. With one
/// experiment the band is empty. Throws ShapeError for another number of x.
Curve curve_of(const std::string& method, const Vector& x, const RowMatrix& experiments);

/// Draws all curves in one panel; a curve of one point is a dot. Throws InputError for no or too
/// many curves, or one without points, and ShapeError for members of different sizes.
Figure figure_of(const CurvePlot& plot);

}  // namespace npdr::analysis
