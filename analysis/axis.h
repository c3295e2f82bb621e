/// Axes with few ticks, for panels that have little room.
#pragma once

#include <string>
#include <vector>

#include "core/constants.h"
#include "core/types.h"

namespace npdr::analysis {

/// Range of the values that were added; those that aren't finite don't count.
struct Range {
  double lower = kInfinity;
  double upper = -kInfinity;

  void add(double value);
  void add(const Eigen::Ref<const Vector>& values);
  /// Length; |value|, or 1e-3 where that is more, when there is but one value.
  double length() const;
  /// The range with `margin` lengths more at both ends; [0, 1] when nothing was added.
  Range widened(double margin) const;
};

struct Axis {
  double lower = 0.0;  ///< SI
  double upper = 1.0;  ///< SI
  std::string title = {};
  std::string unit = {};           ///< "[10⁻³ N m s/rad]", "[kg]", or "" when dimensionless
  double scale = 1.0;              ///< a value is shown as value * scale, a power of ten
  std::vector<double> ticks = {};  ///< scaled positions, ascending
  std::vector<std::string> labels = {};  ///< of the ticks
};

/// Part that make_axis() keeps free of ticks at both ends, as a share of the axis, so that labels
/// of neighboring panels don't meet.
inline constexpr double kTickMargin = 0.08;

/// The axis whose ticks are multiples of a round number, the largest that leaves at least
/// `min_ticks` of them and keeps `margin` off both ends. Labels have equal decimals. Values are
/// scaled by a power of ten where that makes labels shorter. `unit` is SI; "1" or "":
/// dimensionless. Throws InputError unless lower < upper, both finite.
Axis make_axis(const Range& range, const std::string& title, const std::string& unit,
               int min_ticks = 2, double margin = kTickMargin);

}  // namespace npdr::analysis
