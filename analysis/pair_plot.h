/// Pair plot of posterior samples, as in Figures A1 and A2.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.h"
#include "core/types.h"

namespace npdr::analysis {

inline constexpr Index kMinPairParameters = 1;
inline constexpr Index kMaxPairParameters = 15;

/// An axis of the plot, SI.
struct PairParameter {
  std::string label;  ///< such as "rotary_damping"; underscores are shown as blanks
  std::string unit;   ///< SI; "1": dimensionless
  double lower = 0.0;
  double upper = 0.0;
};

/// Samples of one posterior.
struct SampleSet {
  std::string name;   ///< such as "NPDR (MAF)"
  RowMatrix samples;  ///< (n, D), SI, the columns in the order of the parameters
};

struct PairPlot {
  std::string name;  ///< of the files: letters, digits, '_' and '-'
  std::vector<PairParameter> parameters;
  std::vector<SampleSet> sets;           ///< blue, orange, purple, ...; the first is drawn on top
  std::vector<MarkedPoint> points = {};  ///< SI
  std::vector<Index> selection = {};     ///< parameters to show, 1 to 15; empty: the first 15
  Index num_points = 200;                ///< of each set in an off-diagonal panel
};

/// Draws the lower triangle of scatter plots, with the marginal densities of all samples on the
/// diagonal (analysis/density_curve.h), each over its peak, and single points marked. Off the
/// diagonal every panel shows the same samples, evenly strided. Samples outside of the axes are not
/// shown; a parameter that doesn't vary within a set has no density, and gets a line. Throws
/// InputError for none or more than 15 parameters, more sets than there are colors, or a selection
/// that doesn't exist; ShapeError for samples or points of another width.
Figure figure_of(const PairPlot& plot);

}  // namespace npdr::analysis
