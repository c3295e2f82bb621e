#include "pipeline/process/forked_trial.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>

namespace npdr::pipeline {
namespace {

constexpr rlim_t kMaxSeconds = 60;  // of processor time
constexpr std::array kCrashes = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGALRM};

[[noreturn]] void act_and_exit(const std::function<void()>& action, unsigned time_limit,
                               pid_t parent) {
  const rlimit limit{kMaxSeconds, kMaxSeconds + 1};
  setrlimit(RLIMIT_CPU, &limit);
  prctl(PR_SET_DUMPABLE, 0);  // no core file
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);  // it died before
  for (const int signal : kCrashes) std::signal(signal, SIG_DFL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) std::signal(signal, SIG_DFL);
  alarm(time_limit);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  try {
    action();
  } catch (...) {  // the parent will see for itself
  }
  _exit(0);
}

// Others, such as SIGKILL for want of memory, say nothing of the action.
bool is_crash(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status) != 0;
  return std::ranges::find(kCrashes, WTERMSIG(status)) != kCrashes.end();
}

}  // namespace

bool survives(const std::function<void()>& action, unsigned time_limit) {
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) act_and_exit(action, time_limit, parent);
  if (child < 0) return true;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return true;
  }
  return !is_crash(status);
}

InputError damaged_file(const std::filesystem::path& path) {
  return InputError(path.string() +
                    ": is damaged: the HDF5 library crashes on it or doesn't come to an end; copy "
                    "it again from its source");
}

}  // namespace npdr::pipeline
