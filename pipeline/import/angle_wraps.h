/// Angles that a device wraps: at the end of a turn they jump back by a whole one.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// Jumps of one period.
struct AngleJumps {
  double period = 0.0;      ///< a whole turn in the numbers of the column
  std::vector<Index> rows;  ///< t of each jump from sample t to t + 1
};

/// Jumps of a recorded angle (n) by about a whole turn: what is left of such a step without the
/// turn is at most a quarter of one, as are the steps around it, from which it differs by less than
/// 0.15 of one, and these don't go on as fast. In [rad], jumps of 360 are found, too, where no
/// angle is larger: of degrees. No rows without jumps, or in another unit.
AngleJumps find_jumps(const Vector& angle, const std::string& unit);

/// The states that jump by whole turns, after which row (the first is 1) of which rollout first,
/// and the option of `npdr import` that helps.
Findings find_turns(const Target& recording);

/// Samples of a rate (n), `dt` [s] apart, that would move the angle by a whole turn in one step, or
/// by half of one in each of two, while those around them are small: differences of an angle that
/// wraps. `unit` is the angle's; 0 for others.
Index count_spikes(const Vector& rate, double dt, const std::string& unit);

/// Adds whole turns to the samples so that no step is longer than half of one; returns the number
/// of steps that were.
Index unwrap(Eigen::Ref<Vector, 0, Eigen::InnerStride<>> angle, double period);

/// The same of the states with these labels, in all rollouts, with a note of each. Throws
/// InputError for labels that no state has, and for units other than [rad] and [deg].
Findings unwrap_turns(Target& recording, const std::vector<std::string>& labels);

}  // namespace npdr::pipeline
