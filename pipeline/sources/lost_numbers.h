/// What made rows of a program's diverge, for people.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/target.h"
#include "core/types.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Says of the first of `rows` that diverged which number isn't finite, or isn't one that a float
/// holds: "a row has nan in 'omega', step 17 of rollout 2". `given`: the rows' numbers as the
/// program gave them, (n, N, C), N steps of all rollouts, or (n, F) where `steps`, those of one
/// rollout, is 0. "": none diverged by its numbers.
std::string first_lost_number(std::span<const double> given, const sim::Trajectories& rows,
                              const std::vector<Channel>& channels, Index steps);

}  // namespace npdr::pipeline
