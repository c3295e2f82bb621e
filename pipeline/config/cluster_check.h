/// Checks of [cluster] that need more than one key.
#pragma once

#include <optional>
#include <string>

#include "pipeline/config/problems.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Fails where a time limit isn't longer than the warning before it: a job would be asked to stop
/// before it has begun.
void check_cluster(const Study& study, Reading& reading);

/// [s] of a time as Slurm takes it: "90" (minutes), "MM:SS", "HH:MM:SS", "D-HH[:MM[:SS]]"; none for
/// "".
std::optional<double> seconds_of(const std::string& time);

}  // namespace npdr::pipeline
