#include "sim/library/call_watch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "core/printable.h"

namespace npdr::sim {

CallWatch::CallWatch(std::filesystem::path file, double time_limit)
    : file_(std::move(file)),
      time_limit_(time_limit),
      thread_([this](const std::stop_token& stop) { look(stop); }) {}

// Calls are many and short: the thread looks now and then, rather than be woken by each.
void CallWatch::look(const std::stop_token& stop) {
  const auto pause =
      std::min<std::chrono::duration<double>>(time_limit_ / 10.0, std::chrono::seconds(1));
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    stopped.wait_for(lock, stop, pause, [] { return false; });
    if (running_.empty()) continue;
    const Call& oldest = *running_.front();
    if (Call::Clock::now() - oldest.start_ > time_limit_) end_program(oldest);
  }
}

// Whoever holds a lock of the streams may be what loops: the message goes past them.
void CallWatch::end_program(const Call& call) const {
  const std::string message = printable_line(
      fmt::format("{}: {}() hasn't returned after {} s (simulator.time_limit){}: it must for every "
                  "theta; bound "
                  "its loops, and give rows that don't get to their end the status NPDR_DIVERGED",
                  file_.string(), call.function_, time_limit_.count(), call.words_()));
  dprintf(STDERR_FILENO, "%s%s\n", isatty(STDERR_FILENO) == 1 ? "\n" : "", message.c_str());
  _exit(EXIT_FAILURE);
}

CallWatch::Call::Call(CallWatch& watch, const char* function, Words words)
    : watch_(watch), function_(function), words_(std::move(words)) {
  const std::lock_guard lock(watch_.mutex_);
  place_ = watch_.running_.insert(watch_.running_.end(), this);
}

CallWatch::Call::~Call() {
  const std::lock_guard lock(watch_.mutex_);
  watch_.running_.erase(place_);
}

}  // namespace npdr::sim
