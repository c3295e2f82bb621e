/// Tails: those of importance weights, and beyond what was drawn.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Generalized Pareto distribution of excesses over a threshold.
struct ParetoTail {
  double k = 0.0;  ///< shape; 0: exponential
  double scale = 1.0;

  /// P(excess >= y) = (1 + k y / scale)^(-1 / k), y >= 0 and k >= 0.
  double probability_beyond(double y) const;
};

/// Fit to one excess or more, (m) >= 0, ascending, the last one above 0 (Zhang and Stephens 2009,
/// "A new and efficient estimation method for the generalized Pareto distribution", with the prior
/// of Vehtari et al. 2024, "Pareto smoothed importance sampling": ten more excesses whose k is
/// 0.5). k may not be finite.
ParetoTail fit_pareto_tail(const Vector& excess);

/// k of the generalized Pareto distribution that fits the largest min(0.2 n, 3 sqrt n) of the
/// weights (n) >= 0 (fit_pareto_tail()). Means by these weights have a finite variance below 0.5,
/// and are of use below 0.7; above, the largest weights that there are haven't been seen. Infinite
/// for fewer than five weights in the tail, or where they are all the same but 0.
double pareto_k(const Vector& weights);

}  // namespace npdr::inference
