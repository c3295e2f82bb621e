#include "pipeline/import/rate_pairs.h"

#include <algorithm>
#include <set>

namespace npdr::pipeline {

std::string rate_unit(const std::string& unit) {
  if (unit.ends_with("/s")) return unit + "^2";
  return unit + "/s";
}

bool is_rate_of(const Channel& rate, const Channel& position) {
  if (rate.label != position.label + "_dot") return false;
  return rate.unit.empty() || position.unit.empty() || rate.unit == rate_unit(position.unit);
}

namespace {

// "swing speed [rad/s]" of "swing [rad]"; "v [m/s]" of "q [m]" where both units are theirs alone.
bool may_be_rate_of(const Channel& rate, const Channel& position,
                    const std::vector<Channel>& states) {
  if (position.unit.empty() || rate.unit != rate_unit(position.unit)) return false;
  const bool are_alone = std::ranges::count(states, rate.unit, &Channel::unit) == 1 &&
                         std::ranges::count(states, position.unit, &Channel::unit) == 1;
  return are_alone || (rate.label != position.label && rate.label.starts_with(position.label));
}

bool has(const std::vector<RatePair>& pairs, Index channel, Index RatePair::*part) {
  return std::ranges::find(pairs, channel, part) != pairs.end();
}

// Of the state whose name is the longest that the rate's begins with; -1: there is none.
Index likely_position_of(const Channel& rate, const std::vector<Channel>& states) {
  Index found = -1;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!may_be_rate_of(rate, states[i], states) || states[i].label.size() <= longest) continue;
    longest = states[i].label.size();
    found = static_cast<Index>(i);
  }
  return found;
}

}  // namespace

std::vector<RatePair> rate_pairs(const std::vector<Channel>& states) {
  std::vector<RatePair> pairs;
  for (std::size_t rate = 0; rate < states.size(); ++rate) {
    for (std::size_t position = 0; position < states.size(); ++position) {
      if (!is_rate_of(states[rate], states[position])) continue;
      pairs.push_back({static_cast<Index>(position), static_cast<Index>(rate)});
    }
  }
  return pairs;
}

std::vector<RatePair> likely_rate_pairs(const std::vector<Channel>& states) {
  const std::vector<RatePair> named = rate_pairs(states);
  std::vector<RatePair> pairs;
  for (Index rate = 0; rate < std::ssize(states); ++rate) {
    if (has(named, rate, &RatePair::rate)) continue;
    const Index position = likely_position_of(states[static_cast<std::size_t>(rate)], states);
    if (position < 0 || has(named, position, &RatePair::position)) continue;
    pairs.push_back({position, rate});
  }
  return pairs;
}

std::vector<Index> positions_of(const std::vector<Channel>& states) {
  static const std::set<std::string> lengths_and_angles = {"m", "cm", "mm", "rad", "deg"};
  const std::vector<RatePair> named = rate_pairs(states), likely = likely_rate_pairs(states);
  std::vector<Index> positions;
  for (Index c = 0; c < std::ssize(states); ++c) {
    const bool has_rate = has(named, c, &RatePair::position) || has(likely, c, &RatePair::position);
    const std::string& unit = states[static_cast<std::size_t>(c)].unit;
    const bool is_rate = has(named, c, &RatePair::rate) || has(likely, c, &RatePair::rate);
    if (!is_rate && (has_rate || lengths_and_angles.contains(unit))) positions.push_back(c);
  }
  return positions;
}

}  // namespace npdr::pipeline
