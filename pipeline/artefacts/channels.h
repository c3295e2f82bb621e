/// The channels of a target domain: what a recording must have one column of each.
#pragma once

#include <string>
#include <vector>

#include "core/target.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// States and actions, in the order of their columns.
struct Channels {
  std::vector<Channel> states;
  std::vector<Channel> actions;
};

Channels channels_of(const sim::SimulatorInfo& info);

/// Throws InputError unless `found` are the `expected` channels in their order; says what was found
/// and what is expected. `where` (a file and what the channels are of) begins the message.
void check_channels(const std::string& where, const std::vector<Channel>& found,
                    const std::vector<Channel>& expected);

/// "theta [rad], theta_dot [rad/s]".
std::string to_string(const std::vector<Channel>& channels);

}  // namespace npdr::pipeline
