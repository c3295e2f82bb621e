#include "pipeline/cluster/batch_task.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "core/error.h"
#include "pipeline/cluster/slurm.h"
#include "pipeline/cluster/task_log.h"
#include "pipeline/run/stop_request.h"

namespace npdr::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

// Whole lines at once: what the command writes goes to the same file.
void say(const std::string& line) {
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

pid_t start(std::vector<std::string> command) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, words.front(), nullptr, nullptr, words.data(), environ);
  if (error != 0) throw Error(command.front() + ": can't be started: " + std::strerror(error));
  return pid;
}

int status_of(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

// Waits for the end; a request to stop goes on to the command once.
int wait_for(pid_t pid) {
  constexpr useconds_t pause = 20'000;  // [us]
  bool passed_on = false;
  int status = 0;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (stop_requested() && !passed_on) {
      kill(pid, SIGTERM);
      passed_on = true;
    }
    usleep(pause);
  }
  return status_of(status);
}

bool succeeds(const std::vector<std::string>& command) {
  int status = 0;
  const pid_t pid = start(command);
  while (waitpid(pid, &status, 0) < 0) continue;  // a signal came in between
  return status == 0;
}

// Slurm ends this process once the job is queued again: an exit status before that would count.
void queue_again() {
  const std::string id = current_task_id();
  if (id.empty()) return;
  if (!succeeds(requeue_command(id))) {
    say("npdr task: Slurm doesn't queue this job again; 'npdr submit' goes on where it stopped");
    return;
  }
  say("npdr task: queued again");
  std::signal(SIGTERM, SIG_DFL);
  constexpr unsigned patience = 60;  // [s]
  sleep(patience);
}

}  // namespace

int run_batch_task(const std::vector<std::string>& command) {
  watch_for_stop_requests();
  say(begin_line(current_task_id(), command));
  const auto start_time = Clock::now();
  const int status = wait_for(start(command));
  const std::chrono::duration<double> elapsed = Clock::now() - start_time;
  say(end_line(status, elapsed.count()));
  const bool was_saved = status == static_cast<int>(ExitStatus::checkpointed);
  if (was_saved && stop_signal() == SIGUSR1) queue_again();
  return status;
}

}  // namespace npdr::pipeline
