#include "pipeline/process/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"
#include "core/open_file.h"
#include "core/pipe.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

constexpr int kChildDescriptor = 3;

// The parent's environment with the variables that a child gets. Threads that wait for others
// sleep, unless the user wants them to spin: beside another process that has the core, spinning
// takes many times as long as the work.
std::vector<std::string> child_environment(int threads) {
  std::vector<std::string> variables = {"OMP_NUM_THREADS=" + std::to_string(threads),
                                        "NPDR_PROGRESS_FD=" + std::to_string(kChildDescriptor)};
  if (std::getenv("OMP_WAIT_POLICY") == nullptr) variables.push_back("OMP_WAIT_POLICY=passive");
  for (char** v = environ; *v != nullptr; ++v) {
    const std::string variable = *v;
    if (!variable.starts_with("OMP_NUM_THREADS=") && !variable.starts_with("NPDR_PROGRESS_FD=")) {
      variables.push_back(variable);
    }
  }
  return variables;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, int threads,
                           const std::filesystem::path& log) {
  make_folder(log.parent_path());
  // Opened here: posix_spawn() wouldn't say which file it is that it can't open.
  const OpenFile output(log, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW);
  if (!output.is_open()) throw_file_error(log, "be written", errno);
  Pipe ends;
  fcntl(ends.write_end(), F_SETFL, O_NONBLOCK);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output.value(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends.write_end(), kChildDescriptor);
  // A group of its own: Ctrl-C reaches the parent alone, which passes it on.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::vector<std::string> arguments = command, environment = child_environment(threads);
  const int error = posix_spawn(&pid_, command.front().c_str(), &actions, &attributes,
                                pointers(arguments).data(), pointers(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw Error(command.front() + ": can't be started: " + std::strerror(error));
  pipe_ = ends.take(ends.read_end());
}

void ChildProcess::read_progress() {
  std::array<char, 4096> chunk;
  for (;;) {
    const ssize_t count = read(pipe_, chunk.data(), chunk.size());
    if (count <= 0) break;
    buffer_.append(chunk.data(), static_cast<std::size_t>(count));
    last_news_ = Clock::now();
  }
  std::size_t end = 0;
  while ((end = buffer_.find('\n')) != std::string::npos) {
    parse(buffer_.substr(0, end));
    buffer_.erase(0, end + 1);
  }
}

void ChildProcess::parse(const std::string& line) {
  if (line.starts_with('!')) {
    said_.push_back(line.substr(1));
    return;
  }
  if (line.starts_with('?')) {
    state_.note = line.substr(1);
    return;
  }
  std::istringstream words(line);
  State state;
  if (!(words >> state.done >> state.total)) return;
  std::getline(words >> std::ws, state.note);
  const bool is_first = state_.total == 0 && state_.done == 0;
  state.begun = is_first ? state.done : state_.begun;
  state_ = state;
}

bool ChildProcess::has_ended() {
  if (pid_ < 0) return true;
  int status = 0;
  const pid_t ended = waitpid(pid_, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return false;
  if (ended < 0) throw Error(std::string("can't wait for a stage: ") + std::strerror(errno));
  exit_status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  pid_ = -1;
  return true;
}

std::filesystem::path executable_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

void stop_with_parent() {
  const bool has_pipe = std::getenv("NPDR_PROGRESS_FD") != nullptr;
  if (!has_pipe && std::getenv(kTaskMark) == nullptr) return;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (!has_pipe) return;
  // It may have died before: then nobody reads the pipe.
  pollfd pipe = {kChildDescriptor, 0, 0};
  if (poll(&pipe, 1, 0) == 1 && (pipe.revents & POLLERR) != 0) std::raise(SIGTERM);
}

}  // namespace npdr::pipeline
