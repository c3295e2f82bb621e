#include "pipeline/process/shell_call.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "core/error.h"
#include "pipeline/process/stop_request.h"

namespace npdr::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kKeptBytes = 16 << 10;  // of either end of the output
constexpr double kGrace = 1.0;                // [s] between SIGTERM and SIGKILL

// Begin and end of what is added; what lies between is counted.
class BoundedText {
 public:
  void add(const char* data, std::size_t size) {
    const std::size_t room = kKeptBytes - begin_.size();
    const std::size_t taken = std::min(room, size);
    begin_.append(data, taken);
    end_.append(data + taken, size - taken);
    if (end_.size() > 4 * kKeptBytes) drop_middle();
  }

  std::string text() {
    if (end_.size() > kKeptBytes) drop_middle();
    if (num_dropped_ == 0) return begin_ + end_;
    return fmt::format("{}\n... ({} bytes left out) ...\n{}", begin_, num_dropped_, end_);
  }

 private:
  void drop_middle() {
    num_dropped_ += end_.size() - kKeptBytes;
    end_.erase(0, end_.size() - kKeptBytes);
  }

  std::string begin_, end_;
  std::size_t num_dropped_ = 0;
};

std::vector<std::string> environment_of(const ShellCall& call) {
  std::vector<std::string> variables;
  for (char** v = environ; *v != nullptr; ++v) {
    const std::string variable = *v;
    const std::string name = variable.substr(0, variable.find('='));
    const bool is_ours = name == "NPDR_PROGRESS_FD";  // the command has no such descriptor
    if (!is_ours && !call.environment.contains(name)) variables.push_back(variable);
  }
  for (const auto& [name, value] : call.environment) variables.push_back(name + "=" + value);
  return variables;
}

// Whether anything of the process group still runs; its leader may have ended already.
bool group_runs(pid_t group) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
    std::ifstream file(entry.path() / "stat");
    std::string line;
    if (!std::getline(file, line)) continue;
    // pid (name) state parent group ...: the name may hold anything.
    std::istringstream rest(line.substr(std::min(line.rfind(')') + 1, line.size())));
    char state = 'Z';
    pid_t parent = 0, its_group = 0;
    if (rest >> state >> parent >> its_group && its_group == group && state != 'Z') return true;
  }
  return false;
}

// Ends a process group should this process die without having done it, such as by kill -9: a child
// that waits for the end of a pipe which only this process has open for writing.
class Guard {
 public:
  explicit Guard(pid_t group) {
    std::array<int, 2> ends;
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return;
    process_ = fork();
    if (process_ == 0) watch(ends[0], group);
    close(ends[0]);
    end_ = ends[1];
  }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;
  ~Guard() {
    if (end_ < 0) return;
    const char done = 1;
    [[maybe_unused]] const ssize_t written = write(end_, &done, 1);
    close(end_);
    while (process_ > 0 && waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

 private:
  // Nothing in here allocates: another thread may have held the allocator's lock.
  [[noreturn]] static void watch(int end, pid_t group) {
    setpgid(0, 0);  // a terminal's Ctrl-C isn't for it
    const int own = dup2(end, 0);
    close_range(1, ~0U, 0);
    char done = 0;
    ssize_t count = 0;
    do {
      count = read(own, &done, 1);
    } while (count < 0 && errno == EINTR);
    if (count == 0) kill(-group, SIGKILL);
    _exit(0);
  }

  pid_t process_ = -1;
  int end_ = -1;
};

// The shell, from its start until nothing of its process group is left.
class Shell {
 public:
  explicit Shell(const ShellCall& call) {
    std::array<int, 2> ends;
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail();
    output_ = ends[0];
    fcntl(output_, F_SETFL, O_NONBLOCK);
    // All that allocates comes before the fork: another thread may hold the allocator's lock.
    std::vector<std::string> environment = environment_of(call);
    std::vector<char*> variables;
    for (std::string& variable : environment) variables.push_back(variable.data());
    variables.push_back(nullptr);
    std::array<std::string, 3> words = {"sh", "-c", call.command};
    std::array<char*, 4> arguments = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    const std::string folder = call.folder.string();
    process_ = fork();
    if (process_ == 0) become_shell(folder.c_str(), ends[1], arguments.data(), variables.data());
    const int error = errno;
    close(ends[1]);
    if (process_ < 0) {
      close(output_);
      errno = error;
      fail();
    }
    setpgid(process_, process_);  // by both, as nobody knows who is first
    guard_.emplace(process_);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;
  ~Shell() {
    end_group(0.0);
    close(output_);
  }

  // Takes in output for up to 20 ms; true once the shell has ended, and with `waits_for_all` all
  // that it has started.
  bool has_ended(bool waits_for_all = false) {
    if (process_ < 0) return true;
    pollfd more = {is_open_ ? output_ : -1, POLLIN, 0};
    poll(&more, 1, is_open_ ? 20 : 1);
    read_output();
    siginfo_t end = {};
    waitid(P_PID, static_cast<id_t>(process_), &end, WEXITED | WNOHANG | WNOWAIT);
    if (end.si_pid == 0 || (waits_for_all && group_runs(process_))) return false;
    // Whatever it has left behind belongs to the call. The group's number is ours until it is
    // reaped.
    kill(-process_, SIGKILL);
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    exit_status_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    process_ = -1;
    read_output();
    return true;
  }

  void end_group(double grace) {
    if (process_ < 0) return;
    const auto start = Clock::now();
    if (grace > 0.0) {
      kill(-process_, SIGTERM);
      kill(-process_, SIGCONT);  // a stopped program couldn't hear it
    }
    bool is_over = false;
    while (!has_ended(!is_over)) {
      is_over = std::chrono::duration<double>(Clock::now() - start).count() >= grace;
      if (is_over) kill(-process_, SIGKILL);
    }
  }

  int exit_status() const { return exit_status_; }
  std::string output() { return text_.text(); }

 private:
  [[noreturn]] static void fail() {
    throw Error(std::string("can't start a shell: ") + std::strerror(errno));
  }

  [[noreturn]] static void become_shell(const char* folder, int output, char** arguments,
                                        char** variables) {
    setpgid(0, 0);
    std::signal(SIGPIPE, SIG_DFL);  // stop_request.h ignores it
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    if (chdir(folder) != 0) {
      dprintf(STDERR_FILENO, "%s: can't be entered: %s\n", folder, std::strerror(errno));
      _exit(126);
    }
    close_range(3, ~0U, 0);
    execve("/bin/sh", arguments, variables);
    _exit(127);
  }

  void read_output() {
    constexpr int most =
        64;  // more than a pipe holds; who writes without end must not keep us here
    std::array<char, 4096> chunk;
    for (int i = 0; i < most && is_open_; ++i) {
      const ssize_t count = read(output_, chunk.data(), chunk.size());
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) is_open_ = false;
      if (count <= 0) return;
      text_.add(chunk.data(), static_cast<std::size_t>(count));
    }
  }

  pid_t process_ = -1;
  std::optional<Guard> guard_;
  int output_ = -1;
  bool is_open_ = true;  // somebody may still write
  int exit_status_ = 0;
  BoundedText text_;
};

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
  Shell shell(call);
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

}  // namespace npdr::pipeline
