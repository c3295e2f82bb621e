/// Work over independent chunks on OpenMP threads.
#pragma once

#include <functional>

#include "core/types.h"

namespace npdr {

/// Cores that this process may use, at least 1: those of its CPU affinity, which taskset and most
/// batch systems set. Quotas of time, as of containers, aren't seen.
int num_cores();

/// Number of threads that parallel work uses (OMP_NUM_THREADS, or num_cores()).
int num_threads();

/// Calls body(i) for i = 0, ..., count - 1 on num_threads() threads, in no particular order. The
/// body must write only what belongs to its own i. The first exception that a body throws is
/// rethrown here after the others have finished; no exception crosses an OpenMP region.
void parallel_for(Index count, const std::function<void(Index)>& body);

}  // namespace npdr
