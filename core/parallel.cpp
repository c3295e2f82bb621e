#include "core/parallel.h"

#include <omp.h>

#include <atomic>
#include <exception>

namespace npdr {

int num_cores() { return omp_get_num_procs(); }

int num_threads() { return omp_get_max_threads(); }

void parallel_for(Index count, const std::function<void(Index)>& body) {
  std::exception_ptr failure;
  std::atomic<bool> failed = false;
#pragma omp parallel for schedule(dynamic, 1)
  for (Index i = 0; i < count; ++i) {
    if (failed.load(std::memory_order_relaxed)) continue;
    try {
      body(i);
    } catch (...) {
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace npdr
