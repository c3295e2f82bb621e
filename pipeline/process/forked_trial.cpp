#include "pipeline/process/forked_trial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

constexpr std::array kCrashes = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL};
constexpr std::array kTimeouts = {SIGXCPU, SIGALRM};

// A slow disk reads them.
constexpr std::uintmax_t kBytesPerSecond = 20'000'000;
constexpr std::uintmax_t kMaxMoreSeconds = 6 * 3600;

[[noreturn]] void act_and_exit(const std::function<void()>& action, const TrialLimits& limits,
                               pid_t parent) {
  rlimit limit{};
  getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_max = std::min<rlim_t>(limit.rlim_max, limits.cpu_seconds + 1);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, limits.cpu_seconds);
  setrlimit(RLIMIT_CPU, &limit);
  prctl(PR_SET_DUMPABLE, 0);  // no core file
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);  // it died before
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  alarm(limits.seconds);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  try {
    action();
  } catch (...) {  // the parent will see for itself
  }
  _exit(0);
}

// Other signals, such as SIGKILL for want of memory, say nothing of the action.
Ending ending_of(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status) == 0 ? Ending::came_back : Ending::crashed;
  if (std::ranges::count(kTimeouts, WTERMSIG(status)) > 0) return Ending::ran_out_of_time;
  const bool is_crash = std::ranges::count(kCrashes, WTERMSIG(status)) > 0;
  return is_crash ? Ending::crashed : Ending::came_back;
}

// By the size of the file, and of what lies in the folder of its name: shards of a simulation.
TrialLimits limits_for(const std::filesystem::path& path) {
  TrialLimits limits;
  std::error_code error;
  std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return limits;
  const std::filesystem::path shards = std::filesystem::path(path).replace_extension();
  for (std::filesystem::directory_iterator entry(shards, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code unknown;
    const std::uintmax_t more = entry->file_size(unknown);
    size += unknown ? 0 : more;
  }
  const auto more = static_cast<unsigned>(std::min(size / kBytesPerSecond, kMaxMoreSeconds));
  return {limits.cpu_seconds + more, limits.seconds + more};
}

}  // namespace

Ending try_in_child(const std::function<void()>& action, const TrialLimits& limits) {
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) act_and_exit(action, limits, parent);
  if (child < 0) return Ending::came_back;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return Ending::came_back;
  }
  return ending_of(status);
}

void try_to_read(const std::filesystem::path& path, const std::function<void()>& read) {
  const TrialLimits limits = limits_for(path);
  switch (try_in_child(read, limits)) {
    case Ending::came_back:
      return;
    case Ending::crashed:
      throw InputError(
          path.string() +
          ": is damaged: the HDF5 library crashes on it; copy it again from its source");
    case Ending::ran_out_of_time:
      throw InputError(
          fmt::format("{}: reading it came to no end within {} s of processor time, {} s in all: "
                      "it is damaged, or made to mislead (copy it again from its source), or its "
                      "disk is too slow",
                      path.string(), limits.cpu_seconds, limits.seconds));
  }
}

}  // namespace npdr::pipeline
