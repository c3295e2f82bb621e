/// Which keys of a method its algorithm reads.
#pragma once

#include <string>

#include "inference/algorithms/algorithm_config.h"

namespace npdr::pipeline {

/// Whether `key` of a [[method]] means something to the algorithm: the name and the published
/// figures do to all, a table of another family to none.
bool reads_setting(inference::Algorithm algorithm, const std::string& key);

}  // namespace npdr::pipeline
