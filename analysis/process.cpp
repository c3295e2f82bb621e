#include "analysis/process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include "core/error.h"
#include "core/pipe.h"

namespace npdr::analysis {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& program, int error) {
  throw Error(program + ": can't be run: " + std::strerror(error));
}

std::string name_of(const std::string& variable) { return variable.substr(0, variable.find('=')); }

// This process's variables but for some, and some more.
std::vector<char*> environment_of(const ProcessOptions& options) {
  std::vector<std::string> unset = options.unset;
  std::vector<char*> variables;
  for (const std::string& variable : options.set) {
    unset.push_back(name_of(variable));
    variables.push_back(const_cast<char*>(variable.c_str()));  // as for exec()'s arguments
  }
  for (char** v = environ; *v != nullptr; ++v) {
    if (std::ranges::find(unset, name_of(*v)) == unset.end()) variables.push_back(*v);
  }
  variables.push_back(nullptr);
  return variables;
}

// What a new process needs to become a program, without allocating.
struct Start {
  const char* directory;
  char* const* arguments;
  char* const* variables;
  int errors;  // its standard error
  int reason;  // where the number of an error goes to when it can't
  pid_t parent;
};

[[noreturn]] void become(const Start& start) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != start.parent) _exit(127);
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_DFL);
  const int input = open("/dev/null", O_RDONLY), output = open("/dev/null", O_WRONLY);
  const bool is_ready = dup2(input, STDIN_FILENO) >= 0 && dup2(output, STDOUT_FILENO) >= 0 &&
                        dup2(start.errors, STDERR_FILENO) >= 0 && chdir(start.directory) == 0;
  if (is_ready) execvpe(start.arguments[0], start.arguments, start.variables);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(start.reason, &error, sizeof(error));
  _exit(127);
}

// A program that has been started, with its deadline.
class Running {
 public:
  Running(pid_t process, double time_limit)
      : process_(process),
        deadline_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(time_limit))) {}

  // Why it didn't become the program; 0: it did.
  static int failure(int reason) {
    int error = 0;
    ssize_t count = 0;
    do {
      count = read(reason, &error, sizeof(error));
    } while (count < 0 && errno == EINTR);
    return error;
  }

  // All that comes until the end of the pipe, or the deadline.
  std::string read_all(int pipe) {
    std::string text;
    std::array<char, 4096> buffer;
    for (pollfd more = {pipe, POLLIN, 0}; !is_late();) {
      if (poll(&more, 1, 20) <= 0) continue;
      const ssize_t count = read(pipe, buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      text.append(buffer.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

  // Its exit status; after the deadline it is ended, with all that it has started.
  int wait(const std::string& program) {
    int status = 0;
    for (;;) {
      if (is_late()) kill(-process_, SIGKILL);
      const pid_t ended = waitpid(process_, &status, is_late() ? 0 : WNOHANG);
      if (ended == process_) break;
      if (ended < 0 && errno != EINTR) fail(program, errno);
      poll(nullptr, 0, 1);
    }
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

  // Stays as it is once it is true.
  bool is_late() {
    is_late_ = is_late_ || Clock::now() >= deadline_;
    return is_late_;
  }

 private:
  pid_t process_;
  Clock::time_point deadline_;
  bool is_late_ = false;
};

}  // namespace

ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& directory, const ProcessOptions& options) {
  if (!std::filesystem::is_directory(directory)) {
    throw Error(directory.string() + ": no such folder to run " + program + " in");
  }
  // exec() takes char* const[] for historical reasons and doesn't write to it.
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  const std::vector<char*> variables = environment_of(options);
  Pipe errors, reason;
  const Start start = {directory.c_str(),  argv.data(),        variables.data(),
                       errors.write_end(), reason.write_end(), getpid()};
  const pid_t process = fork();
  if (process == 0) become(start);
  if (process < 0) fail(program, errno);
  errors.close_write_end();
  reason.close_write_end();
  Running running(process, options.time_limit);
  const int error = running.failure(reason.read_end());
  ProcessResult result;
  result.found = error != ENOENT;
  result.errors = running.read_all(errors.read_end());
  result.exit_status = running.wait(program);
  result.timed_out = running.is_late();
  if (result.found && error != 0) fail(program, error);
  return result;
}

}  // namespace npdr::analysis
