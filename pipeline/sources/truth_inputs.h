/// How the rollouts of a simulated target domain begin, where no behavior policy says so.
#pragma once

#include "core/target.h"
#include "pipeline/config/study.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Rollouts of a truth with initial states and actions, those of target.inputs or else of
/// simulator.initial_states, in turn, with actions 0; held-out ones last. All other states are 0.
/// Throws InputError for inputs that can't be read, have other channels or too few rollouts, and
/// for initial states of another width.
Target begun_truth(const Study& study, const sim::SimulatorInfo& info);

}  // namespace npdr::pipeline
