/// Rules between a study and the rollouts of its target domain.
#pragma once

#include <vector>

#include "core/target.h"
#include "pipeline/config/reading.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Sizes of the rollouts that are known before any is simulated.
struct RolloutShape {
  Index num_rollouts = 0;
  Index num_steps = 0;
  std::vector<Channel> state_channels;
};

/// Adds what doesn't fit to `reading`; a field that already has a problem isn't checked.
void check_rollouts(const Study& study, const RolloutShape& shape, Reading& reading);

/// The same for the recording of a study that has been read: throws InputError with a line per
/// problem, at the place where the key stands, and for a dt that isn't that of the study's
/// [policy].
void check_recording(const Study& study, const Target& recording);

/// Says which channel of the rollouts is 0 throughout one of them, but perhaps for its first or
/// last state: no error can be given in units of its maximum. "": none.
std::string motion_problem(const Study& study, const Target& rollouts);
/// Throws InputError with that.
void require_motion(const Study& study, const Target& rollouts);

}  // namespace npdr::pipeline
