/// Rollouts of different lengths as those of one target, which are all as long.
#pragma once

#include <optional>

#include "core/finding.h"
#include "core/target.h"

namespace npdr::pipeline {

/// Cuts all rollouts into pieces of `length` steps, 0: those of the shortest; none: checks that
/// they are equally long. A piece begins at the state that was recorded there, and is a rollout
/// with the name "rollout.piece", where there are several. Returns what came of it, in a sentence.
/// Throws InputError for a rollout with fewer steps, and for lengths that differ, with the option
/// that helps.
Findings cut_rollouts(Target& target, const std::optional<Index>& length);

}  // namespace npdr::pipeline
