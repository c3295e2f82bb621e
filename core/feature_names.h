/// Names of channels, and of features of x, with their units, as people write them: "peak [m]".
#pragma once

#include <string>
#include <vector>

#include "core/target.h"

namespace npdr {

/// Splits "x[0] [m]" into the label x[0] and the unit m, which is what stands in the last brackets,
/// at the end and after a blank. A text without them, such as "x[0]", is a label with the unit "".
Channel parse_channel(const std::string& text);

/// The same, but what has no unit has the unit 1.
Channel parse_feature(const std::string& name);
std::vector<Channel> parse_features(const std::vector<std::string>& names);

/// The inverse: "peak [m]", and no unit where it is 1.
std::string feature_name(const Channel& feature);
std::vector<std::string> feature_names(const std::vector<Channel>& features);

/// Who has named the features of x that a study has: without `features` of its own these are called
/// as the columns of x_o, or x0, x1, ... where these have no names.
enum class NamesFrom { study, observation, nobody };

/// x0, x1, ...: features that nobody has named.
std::vector<Channel> numbered_features(Index count);

}  // namespace npdr
