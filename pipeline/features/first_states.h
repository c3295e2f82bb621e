/// States that the segments of a recording begin in, other than the recorded ones.
#pragma once

#include <vector>

#include "core/target.h"
#include "core/types.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Steps that the segments of a rollout begin with, as the study replays it; without those that no
/// state is stored of. S of H rollouts.
std::vector<Index> segment_starts(const sim::SimulatorConfig& simulator, Index num_steps);

/// `target`, whose segments begin in `first_states` (S, C), rollout by rollout. Throws ShapeError.
Target begun_in(const RowMatrix& first_states, const std::vector<Index>& starts, Target target);

/// Those of `target` itself, (S, C).
RowMatrix first_states_of(const Target& target, const std::vector<Index>& starts);

}  // namespace npdr::pipeline
