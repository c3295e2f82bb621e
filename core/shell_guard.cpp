#include "core/shell_guard.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include "core/error.h"
#include "core/pipe.h"

namespace npdr {
namespace {

// What the new process does, down to watch(). Nothing of it allocates: another thread may have held
// the allocator's lock.

void say(int number) {
  [[maybe_unused]] const ssize_t written = write(STDOUT_FILENO, &number, sizeof(number));
}

// What others left behind has ended, and would stay a zombie as long as this process lives.
void reap_orphans(pid_t shell) {
  for (;;) {
    siginfo_t end = {};
    if (waitid(P_ALL, 0, &end, WEXITED | WNOHANG | WNOWAIT) != 0) return;
    if (end.si_pid == 0 || end.si_pid == shell) return;
    waitpid(end.si_pid, nullptr, WNOHANG);
  }
}

// Says how the shell ended; comes back when this isn't to go on.
void wait_for_end(pid_t shell) {
  sigset_t child;
  sigemptyset(&child);
  sigaddset(&child, SIGCHLD);
  sigprocmask(SIG_BLOCK, &child, nullptr);
  const int news = signalfd(-1, &child, SFD_CLOEXEC);
  const int patience = news < 0 ? 10 : -1;  // [ms], where there is no descriptor for it to be told
  bool is_told = false;
  for (;;) {
    // The group's number is ours until the shell is reaped.
    siginfo_t end = {};
    waitid(P_PID, static_cast<id_t>(shell), &end, WEXITED | WNOHANG | WNOWAIT);
    reap_orphans(shell);
    if (end.si_pid != 0 && !is_told) {
      say(end.si_code == CLD_EXITED ? end.si_status : 128 + end.si_status);
      is_told = true;
    }
    std::array<pollfd, 2> events = {pollfd{STDIN_FILENO, POLLIN, 0},
                                    pollfd{is_told ? -1 : news, POLLIN, 0}};
    if (poll(events.data(), events.size(), is_told ? -1 : patience) <= 0) continue;
    if (events[0].revents != 0) return;
    signalfd_siginfo which;
    [[maybe_unused]] const ssize_t count = read(news, &which, sizeof(which));
  }
}

void kill_children() {
  std::array<char, 64> path;
  std::snprintf(path.data(), path.size(), "/proc/self/task/%d/children", getpid());
  std::array<char, 4096> list{};
  const int file = open(path.data(), O_RDONLY);
  if (file < 0) return;  // not every kernel has this list
  const ssize_t size = read(file, list.data(), list.size());
  close(file);
  pid_t child = 0;
  for (ssize_t i = 0; i < size; ++i) {
    const char c = list[static_cast<std::size_t>(i)];
    const bool is_end = c == ' ';  // a number without it is cut, and comes first the next time
    if (is_end && child > 0) kill(child, SIGKILL);
    child = is_end ? 0 : 10 * child + (c - '0');
  }
}

// What loses its parent becomes a child of this process.
void end_all(pid_t shell) {
  constexpr int patience = 5000;  // [ms], for what hangs in a call of the system
  kill(-shell, SIGKILL);
  for (int i = 0; i < patience; ++i) {
    kill_children();
    pid_t reaped = 0;
    do {
      reaped = waitpid(-1, nullptr, WNOHANG);
    } while (reaped > 0);
    if (reaped < 0) return;
    poll(nullptr, 0, 1);
  }
}

[[noreturn]] void watch(int control, int report, const std::function<void()>& become) {
  setpgid(0, 0);  // a terminal's Ctrl-C isn't for it
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t shell = fork();
  const int error = errno;
  if (shell == 0) become();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) std::signal(signal, SIG_IGN);
  dup2(control, STDIN_FILENO);
  dup2(report, STDOUT_FILENO);
  closefrom(2);
  say(shell < 0 ? -error : shell);
  if (shell > 0) wait_for_end(shell);
  if (shell > 0) end_all(shell);
  _exit(0);
}

[[noreturn]] void fail(int error) {
  throw Error(std::string("can't start a shell: ") + std::strerror(error));
}

}  // namespace

ShellGuard::ShellGuard(const std::function<void()>& become) {
  Pipe control, report;
  process_ = fork();
  if (process_ == 0) watch(control.read_end(), report.write_end(), become);
  if (process_ < 0) fail(errno);
  report.close_write_end();
  pollfd first = {report.read_end(), POLLIN, 0};
  while (poll(&first, 1, -1) < 0 && errno == EINTR) {
  }
  control_ = control.take(control.write_end());
  report_ = report.take(report.read_end());
  shell_ = heard().value_or(-EIO);
  if (shell_ > 0) return;
  end();
  fail(-shell_);
}

ShellGuard::~ShellGuard() { end(); }

void ShellGuard::end() {
  close(control_);
  close(report_);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<int> ShellGuard::exit_status() {
  if (!exit_status_) exit_status_ = heard();
  if (exit_status_ && *exit_status_ < 0) exit_status_ = 128 + SIGKILL;  // as the guard, by somebody
  return exit_status_;
}

// The next number that it has to say: the shell's, then how it ended; negative: that of an error.
// None: not yet.
std::optional<int> ShellGuard::heard() const {
  int number = 0;
  const ssize_t count = read(report_, &number, sizeof(number));
  if (count < 0) return std::nullopt;
  return count == sizeof(number) ? number : -EIO;
}

}  // namespace npdr
