#include "core/shell_call.h"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstring>

#include "core/stop_request.h"

namespace npdr {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kGrace = 1.0;  // [s] between SIGTERM and SIGKILL

}  // namespace

std::string CallResult::words(double time_limit) const {
  if (timed_out) return fmt::format("ended after its time limit of {:.3g} s", time_limit);
  const bool is_signal = exit_status > 128 && exit_status < 128 + NSIG;
  if (!is_signal) return fmt::format("exit status {} after {:.3g} s", exit_status, seconds);
  const int signal = exit_status - 128;
  return fmt::format("signal {} ({}) after {:.3g} s", signal, strsignal(signal), seconds);
}

CallResult run_shell(const ShellCall& call) {
  const auto start = Clock::now();
  CallResult result;
  ShellProcess shell(call.command);
  while (!shell.has_ended()) {
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    result.timed_out = result.seconds >= call.time_limit;
    if (result.timed_out || stop_requested()) shell.end_group(kGrace);
  }
  stop_here_if_requested();
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  result.exit_status = shell.exit_status();
  result.output = shell.output();
  return result;
}

}  // namespace npdr
