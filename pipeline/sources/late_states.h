/// States that come a step late: a frequent slip of programs that simulate motion.
#pragma once

#include <string>

#include "core/target.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Says that every rollout of x (n, H, T, C), in all rows, begins with the state that the recorded
/// one began in, though that moves in its first step, in some channel about as far as in others;
/// "": it doesn't. Wanted are the states after each action. Rows that aren't finite don't count.
std::string late_states(const sim::Trajectories& x, const Target& recorded);

}  // namespace npdr::pipeline
