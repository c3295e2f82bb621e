/// Figures of calibration: histograms of ranks, and curves of coverage.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.h"
#include "core/types.h"

namespace npdr::analysis {

/// Ranks of true parameters among posterior samples of one method.
struct RankCounts {
  std::string method;
  RowMatrix counts;  ///< (B, D) ranks in each of B bins of equal width
};

struct RankPlot {
  std::string name;                     ///< of the files: letters, digits, '_' and '-'
  std::vector<std::string> parameters;  ///< (D)
  std::vector<RankCounts> methods;
};

/// Draws one panel per parameter: each bin's count over the expected one, and the band within which
/// that of uniform ranks lies with a probability of 99 % (normal approximation). Throws InputError
/// for no or too many methods, no parameters or no ranks, and ShapeError for counts of other
/// widths.
Figure figure_of(const RankPlot& plot);

/// One method's share of truths within the credible regions of each level.
struct CoverageCurve {
  std::string method;
  Vector level;     ///< (k)
  Vector coverage;  ///< (k)
};

struct CoveragePanel {
  std::string title;
  std::vector<CoverageCurve> curves;
};

struct CoveragePlot {
  std::string name;
  std::vector<CoveragePanel> panels;
  Index num_truths = 0;  ///< whose number sets the width of the band; 0: there is none
};

/// Draws the panels side by side, with the diagonal and its 99 % band, if any. Throws as above.
Figure figure_of(const CoveragePlot& plot);

}  // namespace npdr::analysis
