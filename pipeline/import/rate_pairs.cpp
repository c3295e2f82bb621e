#include "pipeline/import/rate_pairs.h"

#include <algorithm>

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

// "swing speed [rad/s]" of "swing [rad]".
bool may_be_rate_of(const Channel& rate, const Channel& position) {
  return rate.label != position.label && rate.label.starts_with(position.label) &&
         !position.unit.empty() && rate.unit == rate_unit(position.unit);
}

bool has_rate(const std::vector<RatePair>& pairs, Index position) {
  return std::ranges::find(pairs, position, &RatePair::position) != pairs.end();
}

bool has_position(const std::vector<RatePair>& pairs, Index rate) {
  return std::ranges::find(pairs, rate, &RatePair::rate) != pairs.end();
}

// Pairs whose rate is named otherwise: it goes with the longest name that it begins with.
void add_pairs_by_unit(const std::vector<Channel>& states, std::vector<RatePair>& pairs) {
  const std::vector<RatePair> named = pairs;
  for (Index rate = 0; rate < std::ssize(states); ++rate) {
    if (has_position(named, rate)) continue;
    const Channel& channel = states[static_cast<std::size_t>(rate)];
    std::vector<Index> positions;
    for (Index i = 0; i < std::ssize(states); ++i) {
      const bool may_be = may_be_rate_of(channel, states[static_cast<std::size_t>(i)]);
      if (may_be && !has_rate(pairs, i)) positions.push_back(i);
    }
    if (positions.empty()) continue;
    pairs.push_back({*std::ranges::max_element(
                         positions, {},
                         [&](Index i) { return states[static_cast<std::size_t>(i)].label.size(); }),
                     rate});
  }
  std::ranges::sort(pairs, {}, &RatePair::rate);
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
  add_pairs_by_unit(states, pairs);
  return pairs;
}

}  // namespace npdr::pipeline
