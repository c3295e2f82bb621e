/// State channels of which one is the rate of change of another, theta [rad] and theta_dot [rad/s],
/// and rates that a recording lacks, computed of its positions.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// Positions among the state channels.
struct RatePair {
  Index position, rate;
  friend bool operator==(const RatePair&, const RatePair&) = default;
};

/// "rad/s" of "rad", "m/s^2" of "m/s", "1/s" of "1".
std::string rate_unit(const std::string& unit);

/// Whether the rate's label is the position's with _dot behind it, and its unit that per second; an
/// empty unit may be any.
bool is_rate_of(const Channel& rate, const Channel& position);

/// All pairs, in the order of the rates.
std::vector<RatePair> rate_pairs(const std::vector<Channel>& states);

/// Pairs whose rate is named otherwise: its unit is the position's per second, and its name begins
/// with the position's, as of "swing [rad]" and "swing speed [rad/s]", or no other state has either
/// unit, as of "q [m]" and "v [m/s]".
std::vector<RatePair> likely_rate_pairs(const std::vector<Channel>& states);

/// Positions: lengths, angles and what has a rate.
std::vector<Index> positions_of(const std::vector<Channel>& states);

/// Steps from each value (n) to the next one, (n - 1).
Vector differences(const Vector& values);

struct RateOptions {
  Index window = 11;          ///< samples that a slope is taken over
  bool at_rest = false;       ///< rates are 0 at the first states
  bool is_resampled = false;  ///< positions lie on straight lines between those that were recorded
};

/// Sets the rates of `pairs` in every rollout to the slopes of their positions
/// (sim/savitzky_golay.h). Returns a note of each pair, and a warning with rollout and row where
/// slopes over 5 samples differ from these by more than 5 % of the largest rate and by more than
/// 7 sigma / dt: the motion bends too much for the window, or a sample near is wrong, missing or
/// repeated. sigma is the largest of the scatter (analysis/scatter.h) of all positions, that of 41
/// before, around and after the place, and an encoder's count / sqrt(12). White noise gives the
/// difference a standard deviation of at most 1.2 sigma / dt, at the ends. Numbers without noise
/// whose speed jumps time and again look like counts, and aren't told; positions that were
/// resampled aren't looked at. Throws InputError for a window that is none, or longer than a
/// rollout.
Findings compute_rates(Target& target, const std::vector<RatePair>& pairs,
                       const RateOptions& options);

}  // namespace npdr::pipeline
