/// Rollouts of uneven clocks on an even grid of times.
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::pipeline {

/// States and actions at times t_0 + k dt.
struct EvenRows {
  RowMatrix states;   ///< (T + 1, C)
  RowMatrix actions;  ///< (T, A)
};

/// The grid begins at the first time and ends before, or at, the last one. States are interpolated
/// linearly. An action is held from its time to the next one, so each step gets the one that is
/// held in its middle: the one that acts for most of it, also when times are rounded. `times` (n)
/// [s] increase; states (n, C), actions (n - 1, A); dt > 0 [s], at most the whole duration. Throws
/// InputError for a longer one, and for one that makes thousands of rows of each.
EvenRows resampled(const std::vector<double>& times, const RowMatrix& states,
                   const RowMatrix& actions, double dt);

}  // namespace npdr::pipeline
