/// Jumps of recorded channels. Angles that a device wraps jump back by a whole turn at its end.
/// Samples that a sensor got wrong, or lost, are single ones far beyond all others, or leaps.
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

/// Samples t of a recorded channel (n) that lie further than twice the range of its usual values,
/// all but the hundredth (at least one) at either end, from the mean of their neighbors, which lie
/// within a quarter of that distance of each other. Ascending; empty for fewer than 10 samples, and
/// where the usual values are all the same. Steps are none, nor is what comes more often than once
/// in a hundred samples, such as contacts; a rare contact of one sample looks like a glitch.
std::vector<Index> find_glitches(const Vector& values);

/// Steps t -> t + 1 of a recorded position (n): more than four times as
/// large as all others, but for the hundredth (at least three) that they are at most, and than
/// those beside it in the same direction, and at least a fiftieth of the range. Positions hardly
/// leap: samples are missing there, or the sensor stood still. Ascending; empty for fewer than 30
/// samples, and where all other steps are 0.
std::vector<Index> find_lone_steps(const Vector& position);

/// A warning for each rollout and channel with glitches: the first one, how many there are, and
/// what to do. A channel's noise and errors are shares of its largest magnitude, which a glitch
/// sets.
Findings find_glitches(const Target& recording);

/// A warning of each position that leaps (find_lone_steps()), but by whole turns, of the first
/// rollout where it does.
Findings find_leaps(const Target& recording);

/// "theta leaps by 1.2 in the step after 0.4 s, REASON: ...", of the first of these steps.
std::string words_of_leaps(const std::string& label, const Vector& position,
                           const std::vector<Index>& steps, double dt, const std::string& reason);

}  // namespace npdr::pipeline
