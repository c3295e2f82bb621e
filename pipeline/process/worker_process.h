/// A program that stays and answers requests, through its standard input and output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/shell_process.h"

namespace npdr::pipeline {

/// How a request went. `problem` is empty when all of a reply came in time.
struct WorkerReply {
  std::string header;  ///< first line, without its end
  /// "ended in its reply: exit status 1", "no reply within its time limit of 2 s".
  std::string problem;
  bool timed_out = false;
  bool has_ended = false;  ///< the program has
  int exit_status = 0;     ///< its own, where it has ended
  double seconds = 0.0;
};

class WorkerProcess {
 public:
  /// Starts the program, and lets this process ignore SIGPIPE. Throws Error when no process can be
  /// started.
  explicit WorkerProcess(const ShellCommand& command);

  /// Writes a request and reads a reply: a line, and as many bytes as `body_size` says for it, into
  /// `body`, whose memory is best kept from one request to the next.
  /// What it has written before it is asked is a problem, too, as far as it is there by then.
  /// body_size() throws InputError for a line that isn't a reply's. After a problem the program is
  /// of no use: nobody knows what it will write. Throws Checkpointed when this process is asked to
  /// stop.
  WorkerReply exchange(std::span<const char> request, double time_limit,
                       const std::function<std::size_t(const std::string&)>& body_size,
                       std::vector<char>& body);

  /// Text of its standard error since the last call of this function.
  std::string take_output() { return shell_.take_output(); }

 private:
  ShellProcess shell_;
  std::uint64_t num_requests_ = 0;
};

}  // namespace npdr::pipeline
