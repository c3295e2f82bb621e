/// Which keys of a method its algorithm reads.
#pragma once

#include <string>

namespace npdr::pipeline {

/// Whether `key` of a [[method]] means something to the algorithm, a name of algorithm_names(): the
/// name and the published figures do to all, a table of another family to none.
bool reads_setting(const std::string& algorithm, const std::string& key);

}  // namespace npdr::pipeline
