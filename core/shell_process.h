/// A shell in a process group of its own, with all that it starts. What leaves the group, as
/// daemons do, is found where Linux lists the children of a process (CONFIG_PROC_CHILDREN, as in
/// all distributions that we know); elsewhere it is not.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/shell_guard.h"

namespace npdr {

/// A command with its folder and environment.
struct ShellCommand {
  std::string text;              ///< for /bin/sh -c
  std::filesystem::path folder;  ///< where it runs
  std::map<std::string, std::string>
      environment;  ///< variables to set, besides those of this process
};

/// The beginning and the end of a long text, 16 KiB each.
class BoundedText {
 public:
  void add(const char* data, std::size_t size);
  std::string text();

 private:
  void drop_middle();

  std::string begin_, end_;
  std::size_t num_dropped_ = 0;
};

/// A running shell, which ends with all that it has started when this object does, or this process.
class ShellProcess {
 public:
  /// Streams of the shell that lead to this process as they are; others aren't there, or are
  /// output.
  enum class Streams { none, stdin_and_stdout };

  /// Throws Error when no process can be started.
  explicit ShellProcess(const ShellCommand& command, Streams streams = Streams::none);
  ShellProcess(const ShellProcess&) = delete;
  ShellProcess& operator=(const ShellProcess&) = delete;
  ~ShellProcess();

  /// Takes in output for up to 20 ms; true once the shell has ended, and with `waits_for_all` all
  /// that it has started.
  bool has_ended(bool waits_for_all = false);

  /// Ends the group: SIGTERM first, SIGKILL after `grace` seconds.
  void end_group(double grace);

  /// Exit status of the shell that has ended; 128 + signal number when a signal ended it.
  int exit_status() const { return status_.value_or(0); }

  /// Text of its standard error, and its standard output unless that is a stream; begin and
  /// end of it.
  std::string output() { return text_.text(); }
  /// The same, of what has come since the last call of this function.
  std::string take_output() { return std::exchange(text_, {}).text(); }

  /// Takes in output that is there.
  void read_output();
  int output_descriptor() const { return is_open_ ? output_ : -1; }

  /// Where its standard input can be written to, and its standard output read from, without
  /// blocking; -1: they are no streams.
  int input_stream() const { return input_stream_; }
  int output_stream() const { return output_stream_; }

 private:
  pid_t process_ = -1;
  std::unique_ptr<ShellGuard> guard_;
  int output_ = -1;
  int input_stream_ = -1;
  int output_stream_ = -1;
  bool is_open_ = true;        // somebody may still write
  std::optional<int> status_;  // exit status, once it is known
  BoundedText text_;
};

}  // namespace npdr
