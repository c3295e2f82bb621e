/// Names of features of x with their units, as people write them: "peak [m]".
#pragma once

#include <string>
#include <vector>

#include "core/target.h"

namespace npdr {

/// "peak [m]" is the channel peak in m; what has no unit has the unit 1.
Channel parse_feature(const std::string& name);
std::vector<Channel> parse_features(const std::vector<std::string>& names);

/// The inverse: "peak [m]", and no unit where it is 1.
std::string feature_name(const Channel& feature);
std::vector<std::string> feature_names(const std::vector<Channel>& features);

/// x0, x1, ...: features that nobody has named.
std::vector<Channel> numbered_features(Index count);

}  // namespace npdr
