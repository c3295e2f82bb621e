/// Values that repeat: values of a grid, rounded draws, or draws that several simulations share.
#pragma once

#include <map>

#include "core/types.h"
#include "inference/prior.h"

namespace npdr::inference {

/// Different values, each with how often it is there.
using Levels = std::map<double, Index>;

Levels levels_of(const Eigen::Ref<const Vector>& values);

/// The share that levels fill of the places from the least to the largest of them, the smallest
/// step apart: 1 of an even grid, most for draws that are rounded to few places, about 1 / n of n
/// draws. 1 of a single level. Steps below 1e-9 of the range are rounding of the same level.
double filled_by_steps(const Levels& levels);
/// filled_by_steps() of their logarithms; 0 where a level isn't > 0.
double filled_by_factors(const Levels& levels);

/// Whether half of the places or more are filled, by steps or by factors.
bool is_grid(const Levels& levels);

/// Whether `value` has six significant digits at most.
bool is_rounded(double value);
/// Whether values may repeat although each was chosen by itself: levels are a grid, or rounded.
bool are_chosen(const Levels& levels);

/// As many different values as a grid by design has at most.
inline constexpr Index kFewLevels = 20;
/// Whether levels are those of a design: few, chosen, and there twice or more in the mean.
bool is_design(const Levels& levels);

/// How far values are from draws of `marginal`, each level standing for those around it: the
/// largest distance of F(level) from the interval between the share of values below it and the
/// share of those up to it. Draws that are rounded anyhow are as far as the draws were before or
/// less; draws that aren't are by 1 / n nearer than Kolmogorov's and Smirnov's statistic says.
/// Throws InputError for a marginal that is no prior.
double distance_of_levels(const Levels& levels, const Marginal& marginal);

/// P(values of `num_draws` independent draws of `marginal` are as far from it): twice the smaller
/// p-value of Anderson and Darling's test (uniformity.h), which sees shifts and missing tails, and
/// of the mean square of u by chi^2, which sees a wrong width. Values of a level are spread over
/// the ranks that it has, and moved as far as F(level) lies outside of these: rounding isn't seen.
double p_value_of_levels(const Levels& levels, const Marginal& marginal, Index num_draws);

}  // namespace npdr::inference
