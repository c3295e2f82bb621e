/// Child processes of `npdr run`: one stage executable each, with progress through a pipe.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {

/// A running child.
class ChildProcess {
 public:
  /// Starts `command` (a path and its arguments) on `threads` OpenMP threads, in a process group of
  /// its own: signals of the terminal don't reach it. Its output is appended to `log`. Throws Error
  /// when it can't be started.
  ChildProcess(const std::vector<std::string>& command, int threads,
               const std::filesystem::path& log);
  ~ChildProcess() { close(pipe_); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Progress, as the child last reported it.
  struct State {
    Index done = 0;
    Index total = 0;
    Index begun = 0;  ///< `done` as it was first reported: what was there before counts, too
    std::string note;
  };
  /// Warnings, and why it failed, in its own words, line by line (report_error()).
  const std::vector<std::string>& said() const { return said_; }

  int progress_descriptor() const { return pipe_; }
  /// Takes in what has come through the pipe.
  void read_progress();
  const State& state() const { return state_; }
  /// Seconds since anything came, or since its start.
  double silence() const { return seconds_since(last_news_); }

  void send_signal(int signal) const {
    if (pid_ > 0) kill(pid_, signal);
  }
  /// True once the child has ended; then exit_status() is its status, or 128 + the signal.
  bool has_ended();
  int exit_status() const { return exit_status_; }

 private:
  void parse(const std::string& line);

  pid_t pid_ = -1;
  int pipe_ = -1;
  int exit_status_ = 0;
  std::string buffer_;
  State state_;
  std::vector<std::string> said_;
  Clock::time_point last_news_ = Clock::now();
};

/// The folder of the running executable: the stage executables lie beside it.
std::filesystem::path executable_folder();

/// In a child of a scheduler or of a batch task: ask to be stopped when the parent dies.
void stop_with_parent();

}  // namespace npdr::pipeline
