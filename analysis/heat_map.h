/// Figures of a quantity over a grid of two others, one map a method, all with the same colors.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/figure.h"
#include "core/types.h"

namespace npdr::analysis {

struct GridAxis {
  std::string title;  ///< such as "pole_mass"; underscores are shown as blanks
  std::string unit;   ///< "1" or "": dimensionless
  Vector points;      ///< (k), ascending
};

struct HeatMap {
  std::string title;
  RowMatrix values;  ///< (points of x, points of y); NaN is drawn white
};

struct HeatMapPlot {
  std::string name;  ///< of the files: letters, digits, '_' and '-'
  GridAxis x = {};
  GridAxis y = {};
  std::string value_title = {};  ///< of the colors
  double low = 0.0;              ///< what the first and the last color stand for
  double high = 1.0;
  std::vector<HeatMap> maps = {};
  std::optional<std::pair<double, double>> mark = {};  ///< a place in (x, y) to point out
};

/// Draws the maps side by side. Each point of the grid is a cell of the same size, whatever the
/// distances between points; a mark lies in proportion between the middles of its neighbors, and is
/// left out when it is outside of the grid. Throws InputError for no maps, an axis without points
/// or low >= high, and ShapeError for values of another shape than the grid.
Figure figure_of(const HeatMapPlot& plot);

}  // namespace npdr::analysis
