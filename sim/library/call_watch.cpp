#include "sim/library/call_watch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "core/printable.h"

namespace npdr::sim {

// Whoever holds a lock of the streams may be what loops: the message goes past them.
void CallWatch::print(const std::string& message) {
  dprintf(STDERR_FILENO, "%s\n", printable_line(message).c_str());
}

CallWatch::CallWatch(std::filesystem::path file, double time_limit, End end)
    : file_(std::move(file)),
      time_limit_(time_limit),
      end_(std::move(end)),
      thread_([this](const std::stop_token& stop) { look(stop); }) {}

// Calls are many and short: the thread looks now and then, rather than be woken by each.
void CallWatch::look(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  const double pause = std::min(time_limit_ / 10.0, 1.0);
  std::condition_variable_any stopped;
  auto last = Clock::now();
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    stopped.wait_for(lock, stop, std::chrono::duration<double>(pause), [] { return false; });
    const auto seen = Clock::now();
    // What is longer, the process was stopped, as by a batch system or a closed laptop.
    now_ += std::min(std::chrono::duration<double>(seen - last).count(), 2.0 * pause);
    last = seen;
    if (running_.empty()) continue;
    const Call& oldest = *running_.front();
    if (now_ - oldest.start_ > time_limit_) end_program(oldest);
  }
}

void CallWatch::end_program(const Call& call) const {
  end_(fmt::format("{}: {}() hasn't returned after {} s{}", file_.string(), call.function_,
                   time_limit_, call.words_()));
  _exit(EXIT_FAILURE);
}

CallWatch::Call::Call(CallWatch& watch, const char* function, Words words)
    : watch_(watch), function_(function), words_(std::move(words)) {
  const std::lock_guard lock(watch_.mutex_);
  start_ = watch_.now_;
  place_ = watch_.running_.insert(watch_.running_.end(), this);
}

CallWatch::Call::~Call() {
  const std::lock_guard lock(watch_.mutex_);
  watch_.running_.erase(place_);
}

}  // namespace npdr::sim
