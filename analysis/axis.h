/// Tick marks and labels of an axis that has little room.
#pragma once

#include <string>
#include <vector>

namespace npdr::analysis {

/// How an axis over [lower, upper] is labelled.
struct Axis {
  double scale = 1.0;               ///< a value is shown as value * scale, a power of ten
  std::string unit;                 ///< "[10⁻³ N m s/rad]", "[kg]", or "" when dimensionless
  std::vector<double> ticks;        ///< scaled positions, ascending
  std::vector<std::string> labels;  ///< of the ticks, at equal decimals
};

/// The axis whose ticks are multiples of a round number, the largest that leaves at least
/// `min_ticks` of them and keeps 8 % off both ends, so that labels of neighbouring panels don't
/// meet. Values are scaled by a power of ten where that makes labels shorter. `unit` is SI; "1" or
/// "": dimensionless. Throws InputError unless lower < upper, both finite.
Axis make_axis(double lower, double upper, const std::string& unit, int min_ticks = 2);

/// gnuplot's command "set xtics" or "set ytics" (`name` "x" or "y") with further `options`, such as
/// a font; with or without the labels.
std::string tics_command(const Axis& axis, const std::string& name, const std::string& options,
                         bool labelled);

}  // namespace npdr::analysis
