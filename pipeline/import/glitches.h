/// Samples that a sensor got wrong, or lost: single ones far beyond all others, and leaps.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

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
