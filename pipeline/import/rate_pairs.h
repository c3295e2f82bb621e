/// State channels of which one is the rate of change of another: theta [rad] and theta_dot [rad/s].
#pragma once

#include <string>
#include <vector>

#include "core/target.h"

namespace npdr::pipeline {

/// Positions among the state channels.
struct RatePair {
  Index position;
  Index rate;
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

}  // namespace npdr::pipeline
