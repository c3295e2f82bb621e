/// Values that repeat: those of a grid, of rounded draws, or of draws that several simulations
/// share.
#pragma once

#include <map>

#include "core/types.h"
#include "inference/prior.h"

namespace npdr::inference {

/// Different values, each with how often it is there.
using Levels = std::map<double, Index>;

Levels levels_of(const Eigen::Ref<const Vector>& values);

/// How many draws, each there once, are worth as much as different ones that are there m_1, m_2,
/// ... times (Kish 1965, "Survey sampling"): (sum m)^2 / sum m^2. Of any map to how often.
template <class Counts>
double effective_count(const Counts& counts) {
  double sum = 0.0, squares = 0.0;
  for (const auto& [value, count] : counts) {
    sum += static_cast<double>(count);
    squares += static_cast<double>(count) * static_cast<double>(count);
  }
  return sum * sum / squares;
}

/// The share that levels fill of the places from the least to the largest of them, the smallest
/// step apart: 1 of an even grid, most for values that are rounded to few places, about 1 / n of n
/// draws. 1 of a single level.
double filled_by_steps(const Levels& levels);
/// The same of their logarithms; 0 where a level isn't > 0.
double filled_by_factors(const Levels& levels);

/// Whether half of the places or more are filled, by steps or by factors.
bool is_grid(const Levels& levels);

/// How far values are from draws of `marginal`, each level standing for those around it: the
/// largest distance of F(level) from the interval between the share of values below it and the
/// share of those up to it. Draws that are rounded anyhow are as far as the draws were before or
/// less; draws that aren't are by 1 / n nearer than Kolmogorov's and Smirnov's statistic says.
double distance_of_levels(const Levels& levels, const Marginal& marginal);

}  // namespace npdr::inference
