#include "pipeline/artefacts/channels.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

bool same_in_another_order(std::vector<Channel> a, std::vector<Channel> b) {
  const auto by_label = [](const Channel& x, const Channel& y) { return x.label < y.label; };
  std::sort(a.begin(), a.end(), by_label);
  std::sort(b.begin(), b.end(), by_label);
  return a == b;
}

bool same_labels(const std::vector<Channel>& a, const std::vector<Channel>& b) {
  return std::ranges::equal(a, b, {}, &Channel::label, &Channel::label);
}

// "x [mm] in place of [m]" of those that differ in units alone.
std::string differing_units(const std::vector<Channel>& found,
                            const std::vector<Channel>& expected) {
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < found.size(); ++c) {
    if (found[c] == expected[c]) continue;
    parts.push_back(found[c].label + " [" + found[c].unit + "] in place of [" + expected[c].unit +
                    "]");
  }
  return join(parts);
}

}  // namespace

Channels channels_of(const sim::SimulatorInfo& info) {
  return {info.state_channels, info.action_channels};
}

void check_channels(const std::string& where, const std::vector<Channel>& found,
                    const std::vector<Channel>& expected) {
  if (found == expected) return;
  std::string hint;
  if (same_in_another_order(found, expected)) {
    hint = ": the same channels in another order; reorder its columns";
  } else if (same_labels(found, expected)) {
    hint = ": only units differ, " + differing_units(found, expected) +
           "; convert its values, or correct the unit that is wrong";
  }
  throw InputError(where + " are " + to_string(found) + ", must be " + to_string(expected) + hint);
}

std::string to_string(const std::vector<Channel>& channels) {
  std::vector<std::string> parts;
  for (const Channel& channel : channels) {
    parts.push_back(channel.label + " [" + channel.unit + "]");
  }
  return parts.empty() ? "none" : join(parts);
}

}  // namespace npdr::pipeline
