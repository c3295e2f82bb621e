/// Names of the features of x, and of the parameters, where the simulator isn't a built-in one.
#pragma once

#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// "peak [m]" is the channel peak in m; what has no unit has the unit 1.
Channel feature_of(const std::string& name);
std::vector<Channel> features_of(const std::vector<std::string>& names);

/// The inverse: "peak [m]", and no unit where it is 1.
std::string feature_name(const Channel& feature);
std::vector<std::string> feature_names(const std::vector<Channel>& features);

/// x0, x1, ...: features that nobody has named.
std::vector<Channel> numbered_features(Index count);

/// What the study's simulator is about. Of a built-in one, what it says itself. Of a command or a
/// dataset: the parameters of the prior, then those of simulator.parameters, without limits and
/// with the unit 1; the features of x as the state channels of a single step.
sim::SimulatorInfo simulator_info(const Study& study);

}  // namespace npdr::pipeline
