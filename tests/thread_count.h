/// The number of OpenMP's threads.
#pragma once

#include <gtest/gtest.h>
#include <omp.h>

namespace npdr {

/// That number, while it lives.
class ThreadCount {
 public:
  explicit ThreadCount(int count) : before_(omp_get_max_threads()) { omp_set_num_threads(count); }
  ~ThreadCount() { omp_set_num_threads(before_); }
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;

 private:
  int before_;
};

/// Expects three threads to give what one gives.
template <class Body>
void expect_same_for_any_thread_count(const Body& body) {
  const auto by_one = [&] {
    const ThreadCount one(1);
    return body();
  }();
  const ThreadCount three(3);
  EXPECT_EQ(body(), by_one);
}

}  // namespace npdr
