/// One node of a plan, by the function of its stage.
#pragma once

#include <vector>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Makes the artefact of `node`, where it isn't there yet; of a simulation the shards with these
/// numbers (empty: all). Throws InputError for inputs that aren't there, naming the command that
/// makes them, and what the stage throws.
void run_stage(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers = {});

}  // namespace npdr::pipeline
