/// One node of a plan, by the function of its stage.
#pragma once

#include <vector>

#include "pipeline/plan/plan.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {

/// Makes the artefact of `node`, where it isn't there yet; of a simulation the shards with these
/// numbers (empty: all). Throws InputError for inputs that aren't there, naming the command that
/// makes them, and what the stage throws.
void run_stage(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers = {});

/// Helps the refinement `node`, as far as it isn't there yet. Returns the number of rows that were
/// simulated. Throws InputError for other nodes and for inputs that aren't there, and as
/// help_refinement().
Index run_helper(const Plan& plan, const Node& node, const Helper& helper);

}  // namespace npdr::pipeline
