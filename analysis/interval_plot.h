/// Figure of intervals, a row for each thing: which parameters are known, and how well, at a
/// glance.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/figure.h"
#include "core/types.h"

namespace npdr::analysis {

/// Levels of the quantiles that are drawn: the ends of the 90 % and 50 % intervals, and the median.
inline constexpr double kIntervalLevels[] = {0.05, 0.25, 0.5, 0.75, 0.95};

/// Intervals of one posterior.
struct IntervalSet {
  std::string name;     ///< such as "NPDR (MAF)"
  RowMatrix quantiles;  ///< (D, 5) at kIntervalLevels, as places in a row
};

struct IntervalPlot {
  std::string name;                      ///< of the files: letters, digits, '_' and '-'
  std::string title;                     ///< of the axis of places
  Range row = {0.0, 1.0};                ///< the places that a row shows
  std::vector<std::string> parameters;   ///< (D) labels; underscores are shown as blanks
  std::vector<std::string> tips;         ///< (D) words for who points at a row
  std::vector<IntervalSet> sets;         ///< blue, orange, purple, ...; the first on top
  std::vector<MarkedPoint> points = {};  ///< at places in a row
  /// [px] of the whole figure, where names leave rows 150 px; by default rows of 640 px are drawn
  std::optional<double> width = {};
};

/// Draws a row for each parameter, such as one as wide as its prior: a line for each posterior's 90
/// % interval, a thick one for its 50 % interval, a dot for the median, and the marked points.
/// Throws InputError for no parameters and for no or too many sets; ShapeError for quantiles or
/// points of another size.
Figure figure_of(const IntervalPlot& plot);

}  // namespace npdr::analysis
