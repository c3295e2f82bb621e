/// Waiting for events, in tests: nothing else here waits for time to pass.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

namespace npdr {

/// Looks every `interval` whether `condition` holds; false when it doesn't within `limit`.
template <class Condition>
bool comes_true(const Condition& condition,
                std::chrono::duration<double> limit = std::chrono::minutes(1),
                std::chrono::milliseconds interval = std::chrono::milliseconds(2)) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= deadline) return condition();
    std::this_thread::sleep_for(interval);
  }
  return true;
}

/// Tells whether a process has ended, even if nobody has asked for its status yet.
inline bool has_ended(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string stat{std::istreambuf_iterator<char>(file), {}};
  // pid (name) state ...: the name may hold anything.
  const std::size_t name_end = stat.rfind(')');
  return name_end == std::string::npos || stat.compare(name_end, 3, ") Z") == 0;
}

}  // namespace npdr
