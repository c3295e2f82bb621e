#include "core/shell_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "core/pipe.h"
#include "core/stop_request.h"

namespace npdr {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr std::size_t kKeptBytes = 16 << 10;  // of either end of the output
constexpr double kLastWords = 1.0;            // [s] for a program whose requests have ended
constexpr int kStreamBytes = 1 << 20;         // that a stream holds, where the system lets it

std::vector<std::string> environment_of(const ShellCommand& call) {
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

// Streams that a shell has in place of this process's.
struct ShellStreams {
  int input;  // -1: nothing
  int output;
  int error;
};

// In the new process, which must not allocate.
[[noreturn]] void become_shell(const char* folder, const ShellStreams& streams, char** arguments,
                               char** variables) {
  setpgid(0, 0);
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_DFL);  // we ignore them
  const int input = streams.input >= 0 ? streams.input : open("/dev/null", O_RDONLY);
  dup2(input, STDIN_FILENO);
  dup2(streams.output, STDOUT_FILENO);
  dup2(streams.error, STDERR_FILENO);
  if (chdir(folder) != 0) {
    dprintf(STDERR_FILENO, "%s: can't be entered: %s\n", folder, std::strerror(errno));
    _exit(126);
  }
  closefrom(3);
  execve("/bin/sh", arguments, variables);
  _exit(127);
}

}  // namespace

void BoundedText::add(const char* data, std::size_t size) {
  const std::size_t room = kKeptBytes - begin_.size();
  const std::size_t taken = std::min(room, size);
  begin_.append(data, taken);
  end_.append(data + taken, size - taken);
  if (end_.size() > 4 * kKeptBytes) drop_middle();
}

std::string BoundedText::text() {
  if (end_.size() > kKeptBytes) drop_middle();
  if (num_dropped_ == 0) return begin_ + end_;
  return fmt::format("{}\n... ({} bytes left out) ...\n{}", begin_, num_dropped_, end_);
}

void BoundedText::drop_middle() {
  num_dropped_ += end_.size() - kKeptBytes;
  end_.erase(0, end_.size() - kKeptBytes);
}

ShellProcess::ShellProcess(const ShellCommand& command, Streams streams) {
  const bool has_streams = streams == Streams::stdin_and_stdout;
  Pipe error, input, output;
  // All that allocates comes before the fork: another thread may hold the allocator's lock.
  std::vector<std::string> environment = environment_of(command);
  std::vector<char*> variables;
  for (std::string& variable : environment) variables.push_back(variable.data());
  variables.push_back(nullptr);
  std::array<std::string, 3> words = {"sh", "-c", command.text};
  std::array<char*, 4> arguments = {words[0].data(), words[1].data(), words[2].data(), nullptr};
  const std::string folder = command.folder.string();
  const ShellStreams its = {has_streams ? input.read_end() : -1,
                            has_streams ? output.write_end() : error.write_end(),
                            error.write_end()};
  guard_ = std::make_unique<ShellGuard>(
      [&] { become_shell(folder.c_str(), its, arguments.data(), variables.data()); });
  process_ = guard_->shell();
  setpgid(process_, process_);  // by both, as nobody knows who is first
  output_ = error.take(error.read_end());
  if (has_streams) {
    input_stream_ = input.take(input.write_end());
    output_stream_ = output.take(output.read_end());
    for (const int stream : {input_stream_, output_stream_}) {
      fcntl(stream, F_SETPIPE_SZ, kStreamBytes);
    }
  }
}

ShellProcess::~ShellProcess() {
  if (input_stream_ >= 0) close(input_stream_);  // a program that stays ends with its requests
  const auto start = Clock::now();
  while (input_stream_ >= 0 && !has_ended() && !stop_requested() &&
         seconds_since(start) < kLastWords) {
  }
  if (output_stream_ >= 0) close(output_stream_);
  end_group(0.0);
  close(output_);
}

bool ShellProcess::has_ended(bool waits_for_all) {
  if (process_ < 0) return true;
  pollfd more = {is_open_ ? output_ : -1, POLLIN, 0};
  poll(&more, 1, is_open_ ? 20 : 1);
  read_output();
  status_ = guard_->exit_status();
  if (!status_ || (waits_for_all && group_runs(process_))) return false;
  guard_.reset();  // whatever it has left behind belongs to the call
  process_ = -1;
  read_output();
  return true;
}

void ShellProcess::end_group(double grace) {
  if (process_ < 0) return;
  const auto start = Clock::now();
  if (grace > 0.0) {
    kill(-process_, SIGTERM);
    kill(-process_, SIGCONT);  // a stopped program couldn't hear it
  }
  bool is_over = false;
  while (!has_ended(!is_over)) {
    is_over = seconds_since(start) >= grace;
    if (is_over) kill(-process_, SIGKILL);
  }
}

void ShellProcess::read_output() {
  constexpr int most = 64;  // more than a pipe holds; who writes without end must not keep us here
  std::array<char, 4096> chunk;
  for (int i = 0; i < most && is_open_; ++i) {
    const ssize_t count = read(output_, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) is_open_ = false;
    if (count <= 0) return;
    text_.add(chunk.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace npdr
