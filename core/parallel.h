/// Work over independent chunks on OpenMP threads.
#pragma once

#include <functional>

#include "core/types.h"

namespace npdr {

/// Cores that this process may use: those of the machine, less what taskset or a job's allocation
/// keeps from it. At least 1.
int num_cores();

/// Number of threads that parallel work uses (OMP_NUM_THREADS, or the cores of the machine).
int num_threads();

/// Calls body(i) for i = 0, ..., count - 1 on num_threads() threads, in no particular order. The
/// body must write only what belongs to its own i. The first exception that a body throws is
/// rethrown here after the others have finished; no exception crosses an OpenMP region.
void parallel_for(Index count, const std::function<void(Index)>& body);

}  // namespace npdr
