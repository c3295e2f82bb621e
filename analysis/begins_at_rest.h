/// Whether the device of a recording stood still when it began.
#pragma once

#include "core/target.h"

namespace npdr::analysis {

/// Whether the first step of a rollout is less than half of the usual one, as floats see them, in
/// every channel; true where there is no step. Noise as large as steps looks like motion.
bool begins_at_rest(const Rollout& rollout);

}  // namespace npdr::analysis
