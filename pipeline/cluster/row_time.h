/// How long a simulation of one row takes, to pack short shards into tasks.
#pragma once

#include <optional>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// [s] of one core: what complete shards of the study took, else what a few draws of the prior take
/// here; 0 of a dataset. None: not known of a program of the user's, which isn't started for that.
/// Throws InputError for a damaged shard, Error when a truth can't be simulated.
std::optional<double> seconds_per_row(const Plan& plan);

}  // namespace npdr::pipeline
