#include "pipeline/import/rate_pairs.h"

namespace npdr::pipeline {

std::string rate_unit(const std::string& unit) {
  if (unit.ends_with("/s")) return unit + "^2";
  return unit + "/s";
}

bool is_rate_of(const Channel& rate, const Channel& position) {
  if (rate.label != position.label + "_dot") return false;
  return rate.unit.empty() || position.unit.empty() || rate.unit == rate_unit(position.unit);
}

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

}  // namespace npdr::pipeline
