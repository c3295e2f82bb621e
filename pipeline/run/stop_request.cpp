#include "pipeline/run/stop_request.h"

#include <atomic>
#include <csignal>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): all that a handler can reach
std::atomic<bool> requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);  // or a handler could not write it

void handle(int) { requested.store(true, std::memory_order_relaxed); }

}  // namespace

void watch_for_stop_requests() {
  struct sigaction action = {};
  action.sa_handler = handle;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal, &action, nullptr);
}

bool stop_requested() { return requested.load(std::memory_order_relaxed); }

void stop_here_if_requested() {
  if (stop_requested()) throw Checkpointed("stopped on request; run it again to go on");
}

}  // namespace npdr::pipeline
