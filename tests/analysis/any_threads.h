/// Results that may not depend on the number of threads.
#pragma once

#include <gtest/gtest.h>
#include <omp.h>

namespace npdr::analysis {

/// Expects `compute` to give the same bits, of all of its results, on one thread and on several.
template <class Compute>
void expect_same_on_any_threads(const Compute& compute) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = compute();
  omp_set_num_threads(5);
  const auto several = compute();
  omp_set_num_threads(threads);
  EXPECT_TRUE(one == several);
}

}  // namespace npdr::analysis
