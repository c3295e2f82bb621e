#include "pipeline/cluster/batch_task.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/shell_text.h"
#include "core/stop_request.h"
#include "pipeline/cluster/slurm.h"
#include "pipeline/process/build_info.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

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
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

// Slurm ends this process once the job is queued again, at any instant from then on: an exit status
// before that would count.
void queue_again() {
  std::signal(SIGTERM, SIG_DFL);
  say("npdr task: asks to be queued again");
  if (std::system(shell_text(requeue_command(slurm_task_id())).c_str()) != 0) {
    say("npdr task: Slurm doesn't queue this job again; 'npdr submit' goes on where it stopped");
    return;
  }
  constexpr unsigned patience = 10;  // [s]
  sleep(patience);
}

// The time limit came near, and nobody wants the job to end.
bool ran_out_of_time(int status) {
  const bool was_stopped = status == static_cast<int>(ExitStatus::checkpointed) ||
                           is_stop_signal(status - 128);  // before it could listen
  const bool was_canceled =
      stop_signal_came(SIGTERM) || stop_signal_came(SIGINT) || stop_signal_came(SIGHUP);
  return was_stopped && stop_signal_came(SIGUSR1) && !was_canceled;
}

constexpr std::string_view kMark = "npdr task: ";
constexpr std::string_view kEnd = "exit status ";

// The last lines of a file that may be long.
std::vector<std::string> last_lines(const std::filesystem::path& path) {
  constexpr std::streamoff most = 8192;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  if (size <= 0) return {};
  file.seekg(std::max<std::streamoff>(0, size - most));
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

// Finds the message that a program ends with: "program: message". 'npdr run' quotes it from a
// stage, indented below "... failed (exit status 1):".
std::string message_in(const std::vector<std::string>& lines) {
  const auto is_headline = [](const std::string& line) {
    return line.find(" failed (") != std::string::npos && line.ends_with("):");
  };
  const auto headline = std::find_if(lines.rbegin(), lines.rend(), is_headline);
  if (headline != lines.rend() && headline != lines.rbegin()) {
    const std::string& quoted = *std::prev(headline);
    return quoted.substr(std::min(quoted.find_first_not_of(' '), quoted.size()));
  }
  return lines.empty() || lines.back().starts_with(kMark) ? "" : lines.back();
}

}  // namespace

int run_batch_task(const std::vector<std::string>& command) {
  watch_for_stop_requests();
  // A file that appears when a program of the task has made something.
  const std::filesystem::path mark =
      temporary_name(std::filesystem::temp_directory_path() / "npdr-task");
  setenv(kTaskMark, mark.c_str(), 1);
  say(begin_line(slurm_task_id(), command));
  const auto start_time = Clock::now();
  const int status = wait_for(start(command));
  const double seconds = seconds_since(start_time);
  const bool any_made = unlink(mark.c_str()) == 0;
  const bool is_first = std::getenv("SLURM_RESTART_COUNT") == nullptr;
  const bool is_out_of_time = !slurm_task_id().empty() && ran_out_of_time(status);
  if (is_out_of_time && !any_made && !is_first) {
    say("npdr task: nothing got done within the time limit of an attempt that isn't the first; "
        "raise 'time' in the study's [cluster], or lower simulate.shard_size");
    say(end_line(static_cast<int>(ExitStatus::failed), seconds));
    return static_cast<int>(ExitStatus::failed);
  }
  say(end_line(status, seconds));
  if (is_out_of_time) queue_again();
  return status;
}

std::string begin_line(const std::string& id, const std::vector<std::string>& command) {
  return fmt::format("{}{} on {}, {}: {}", kMark, id.empty() ? "no batch job" : id, host_name(),
                     now_utc(), shell_text(command));
}

std::string end_line(int exit_status, double seconds) {
  return fmt::format("{}{}{} after {:.1f} s", kMark, kEnd, exit_status, seconds);
}

std::optional<TaskEnd> end_in_log(const std::filesystem::path& log) {
  const std::vector<std::string> lines = last_lines(log);
  const std::string begin = std::string(kMark) + std::string(kEnd);
  if (lines.empty() || !lines.back().starts_with(begin)) return std::nullopt;
  const std::string& last = lines.back();
  TaskEnd end{0, last.substr(kMark.size())};
  const char* const number = last.data() + begin.size();
  if (std::from_chars(number, last.data() + last.size(), end.exit_status).ptr == number) {
    return std::nullopt;
  }
  const std::string message = message_in({lines.begin(), lines.end() - 1});
  if (!message.empty()) end.words += ": " + message;
  return end;
}

}  // namespace npdr::pipeline
