/// What is probably wrong with a recording that was written without `npdr import`, which asks.
#pragma once

#include <utility>
#include <vector>

#include "core/finding.h"
#include "core/target.h"

namespace npdr::pipeline {

/// One of each angle that jumps by whole turns and each other position that leaps (jumps.h), each
/// rate that isn't the slope of its position (rate_check.h), unless it was computed as one
/// (savitzky_golay.h), and each rollout that is a copy of another.
Findings warnings_of(Target recording);

/// Pairs of rollouts (i, j), i < j, that hold the same numbers: of each j the first i.
std::vector<std::pair<std::size_t, std::size_t>> copies_of(const Target& recording);

}  // namespace npdr::pipeline
