/// What made a row of a program's diverge, for people.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// The first number of a row that isn't finite, or isn't one that a float holds: "nan in 'omega',
/// step 17 of rollout 2". `row`: (N, C), N steps of all rollouts; without the step where
/// `num_steps`, those of one rollout, is 1, as of features. "": there is none.
std::string find_lost_number(std::span<const double> row, const std::vector<Channel>& channels,
                             Index num_steps);

}  // namespace npdr::pipeline
