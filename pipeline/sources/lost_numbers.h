/// What made rows of a program's diverge, for people.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/target.h"
#include "core/types.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// A number that isn't finite, or isn't one that a float holds.
struct LostNumber {
  Index row = 0;
  std::string words;  ///< "nan in 'omega', step 17 of rollout 2"
};

/// The first of them in the first of `rows` that diverged. `given`: the rows' numbers as the
/// program gave them, (n, N, C), N steps of all rollouts, or (n, F) where `steps`, those of one
/// rollout, is 0. None where no row diverged by its numbers.
std::optional<LostNumber> first_lost_number(std::span<const double> given,
                                            const sim::Trajectories& rows,
                                            const std::vector<Channel>& channels, Index steps);

}  // namespace npdr::pipeline
