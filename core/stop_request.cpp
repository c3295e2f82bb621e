#include "core/stop_request.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

#include "core/error.h"

namespace npdr {
namespace {

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): all that a handler can reach
std::atomic<std::uint64_t> signals = 0;  // a bit each
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<std::uint64_t> first_time = 0;                       // [ns] of the first; 0: none came
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);  // or a handler could not write it

constexpr std::array kStopSignals = {SIGINT, SIGTERM, SIGUSR1, SIGHUP};

constexpr std::uint64_t bit_of(int signal) { return std::uint64_t{1} << signal; }

std::uint64_t now() {
  timespec time = {};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000 +
         static_cast<std::uint64_t>(time.tv_nsec);
}

// Whether somebody has lost patience. A batch system and the parent that passes its signals on may
// both ask at about the same time.
bool asks_again(int signal) {
  constexpr std::uint64_t patience = 1'000'000'000;  // [ns]
  if (signal != SIGINT && signal != SIGTERM) return false;
  const std::uint64_t time = now();
  std::uint64_t first = 0;
  return !first_time.compare_exchange_strong(first, time) && time - first >= patience;
}

void handle(int signal) {
  signals.fetch_or(bit_of(signal), std::memory_order_relaxed);
  if (!asks_again(signal)) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

bool is_ignored(int signal) {
  struct sigaction action = {};
  sigaction(signal, nullptr, &action);
  return action.sa_handler == SIG_IGN;
}

}  // namespace

void watch_for_stop_requests() {
  struct sigaction action = {};
  action.sa_handler = handle;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : kStopSignals) {
    if (signal != SIGHUP || !is_ignored(SIGHUP)) sigaction(signal, &action, nullptr);
  }
}

bool is_stop_signal(int signal) {
  return std::find(kStopSignals.begin(), kStopSignals.end(), signal) != kStopSignals.end();
}

bool stop_requested() { return signals.load(std::memory_order_relaxed) != 0; }

bool stop_signal_came(int signal) {
  return (signals.load(std::memory_order_relaxed) & bit_of(signal)) != 0;
}

void stop_here_if_requested() {
  if (stop_requested()) throw Checkpointed("stopped on request; run it again to go on");
}

}  // namespace npdr
