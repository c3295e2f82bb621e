/// Doing something in a child process first, to see whether the process survives it.
#pragma once

#include <functional>

namespace npdr::pipeline {

/// Runs `action` in a copy of this process and throws its results away, exceptions too. False when
/// the copy was ended by a signal: a library crashed. True when that can't be found out. `action`
/// must not use threads.
bool survives(const std::function<void()>& action);

}  // namespace npdr::pipeline
