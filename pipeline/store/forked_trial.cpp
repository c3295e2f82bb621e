#include "pipeline/store/forked_trial.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace npdr::pipeline {
namespace {

[[noreturn]] void act_and_exit(const std::function<void()>& action) {
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE}) std::signal(signal, SIG_DFL);
  try {
    action();
  } catch (...) {  // the parent will see for itself
  }
  _exit(0);
}

}  // namespace

bool survives(const std::function<void()>& action) {
  const pid_t child = fork();
  if (child == 0) act_and_exit(action);
  if (child < 0) return true;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return true;
  }
  return !WIFSIGNALED(status);
}

}  // namespace npdr::pipeline
