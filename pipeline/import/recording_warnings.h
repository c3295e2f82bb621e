/// What is probably wrong with a recording that was written without `npdr import`, which asks.
#pragma once

#include <string>
#include <vector>

#include "core/target.h"

namespace npdr::pipeline {

/// A sentence for each angle that jumps by whole turns (angle_wraps.h), each other position that
/// leaps (glitches.h), each rate that isn't the slope of its position
/// (rate_report.h), unless it was computed as one (savitzky_golay.h), and each rollout that is a
/// copy of another.
std::vector<std::string> recording_warnings(const Target& recording);

}  // namespace npdr::pipeline
