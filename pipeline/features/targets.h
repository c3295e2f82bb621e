/// The target domain as a node of a plan sees it.
#pragma once

#include <optional>

#include "core/target.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// The target domain that `node` needs; `num_rollouts` > 0: only the first ones. Throws InputError.
Target read_target(const Plan& plan, const Node& node, Index num_rollouts = 0);

/// The target rollouts that the method of `node` sees: its first ones of each iteration.
Target read_seen_target(const Plan& plan, const Node& node);

/// The rollouts that inference sees before anything is made: recorded ones, or those that the truth
/// is simulated for here. Throws what Source::behave() does.
Target make_seen_target(const Plan& plan);

/// The rollouts that inference doesn't see, where the study has any.
std::optional<Target> read_held_out(const Plan& plan, const Node& node);

}  // namespace npdr::pipeline
