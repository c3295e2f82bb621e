/// Which keys of a method its algorithm reads.
#pragma once

#include <string>

#include "core/types.h"
#include "inference/algorithms/algorithm_config.h"

namespace npdr::pipeline {

struct MethodConfig;

/// Whether `key` of a [[method]] means something to the algorithm: the name and the published
/// figures do to all, a table of another family to none.
bool reads_setting(inference::Algorithm algorithm, const std::string& key);

/// Simulations of a round that networks learn from: others choose the powers of a pool.
Index num_learned_from(const MethodConfig& method);

}  // namespace npdr::pipeline
