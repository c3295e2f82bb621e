#include "pipeline/artefacts/channels.h"

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
Channels channels_of(const sim::SimulatorInfo& info) {
  return {info.state_channels, info.action_channels};
}

void check_channels(const std::string& where, const std::vector<Channel>& found,
                    const std::vector<Channel>& expected) {
  if (found == expected) return;
  throw InputError(where + " are " + to_string(found) + ", must be " + to_string(expected) +
                   "; rename, reorder or convert its columns");
}

std::string to_string(const std::vector<Channel>& channels) {
  std::vector<std::string> parts;
  for (const Channel& channel : channels) {
    parts.push_back(channel.label + " [" + channel.unit + "]");
  }
  return parts.empty() ? "none" : join(parts);
}

}  // namespace npdr::pipeline
