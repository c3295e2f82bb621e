/// Rollouts that are there twice: they would make posteriors narrower than they are.
#pragma once

#include <utility>
#include <vector>

#include "core/target.h"

namespace npdr::pipeline {

/// Pairs of rollouts (i, j), i < j, that hold the same numbers: of each j the first i.
std::vector<std::pair<std::size_t, std::size_t>> copies_of(const Target& recording);

}  // namespace npdr::pipeline
