#include "pipeline/process/worker_process.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>

#include "core/error.h"
#include "core/shell_call.h"
#include "core/stop_request.h"

namespace npdr::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestHeader = 1 << 20;
constexpr int kPollMilliseconds = 100;  // between two looks at requests to stop

// One request, and what has come of its reply.
class Exchange {
 public:
  Exchange(ShellProcess& shell, std::span<const char> request,
           const std::function<std::size_t(const std::string&)>& body_size, std::vector<char>& body)
      : shell_(shell), unsent_(request), body_size_(body_size), body_(body) {}

  // What is there before a request is sent is no reply to it.
  void require_silence() {
    pollfd output{shell_.output_stream(), POLLIN, 0};
    if (poll(&output, 1, 0) <= 0 || (output.revents & POLLIN) == 0) return;
    reject(
        "it wrote something before it was asked; each request has one reply, and what is for "
        "people belongs on standard error");
  }

  WorkerReply run(double time_limit) {
    const auto start = Clock::now();
    while (!is_complete() && !has_failed()) {
      stop_here_if_requested();
      const bool is_quiet = !go_on();
      reply_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
      if (is_complete()) break;
      if (reply_.seconds >= time_limit) {
        reply_.timed_out = true;
        reply_.problem = fmt::format("no reply within its time limit of {:.3g} s", time_limit);
      } else if ((is_closed_ || is_quiet) && shell_.has_ended()) {
        take_end(time_limit);  // its children may hold the pipe open
      }
    }
    shell_.read_output();
    return std::move(reply_);
  }

 private:
  bool has_reply() const { return has_header_ && num_read_ == body_.size(); }
  bool is_complete() const { return has_reply() && unsent_.empty(); }
  bool has_failed() const { return !reply_.problem.empty(); }

  // Waits until something can be done, and does it. False when nothing could for a while.
  bool go_on() {
    std::array<pollfd, 3> events = {
        pollfd{unsent_.empty() ? -1 : shell_.input_stream(), POLLOUT, 0},
        pollfd{is_closed_ || has_reply() ? -1 : shell_.output_stream(), POLLIN, 0},
        pollfd{shell_.output_descriptor(), POLLIN, 0}};
    const bool is_quiet = poll(events.data(), events.size(), kPollMilliseconds) == 0;
    if (events[2].revents != 0) shell_.read_output();
    if (events[0].revents != 0) send();
    if (events[1].revents != 0) receive();
    return !is_quiet;
  }

  void take_end(double time_limit) {
    reply_.has_ended = true;
    reply_.exit_status = shell_.exit_status();
    const CallResult result{shell_.exit_status(), false, reply_.seconds, ""};
    reply_.problem = (has_header_ ? "ended in its reply: " : "ended in place of a reply: ") +
                     result.words(time_limit);
  }

  void send() {
    const ssize_t count = write(shell_.input_stream(), unsent_.data(), unsent_.size());
    if (count >= 0) unsent_ = unsent_.subspan(static_cast<std::size_t>(count));
    if (count < 0 && errno == EPIPE) unsent_ = {};  // it won't read any more
  }

  void receive() {
    while (!has_reply() && !has_failed()) {
      const ssize_t count = has_header_ ? receive_body() : receive_header();
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) is_closed_ = true;
      if (count <= 0) return;
    }
  }

  ssize_t receive_body() {
    const ssize_t count =
        read(shell_.output_stream(), body_.data() + num_read_, body_.size() - num_read_);
    if (count > 0) num_read_ += static_cast<std::size_t>(count);
    return count;
  }

  // The header, and what of the body has come with it.
  ssize_t receive_header() {
    std::array<char, 4096> chunk;
    const ssize_t count = read(shell_.output_stream(), chunk.data(), chunk.size());
    if (count <= 0) return count;
    const auto end = chunk.begin() + count, line = std::find(chunk.begin(), end, '\n');
    reply_.header.append(chunk.begin(), line);
    if (line == end) {
      if (reply_.header.size() > kLongestHeader) reject("no end of its first line");
      return count;
    }
    has_header_ = true;
    try {
      body_.resize(body_size_(reply_.header));
    } catch (const InputError& error) {
      reject(error.what());
      return count;
    }
    num_read_ = static_cast<std::size_t>(end - line - 1);
    if (num_read_ > body_.size()) {
      reject(fmt::format("{} bytes more than the reply has", num_read_ - body_.size()));
      return count;
    }
    std::copy(line + 1, end, body_.begin());
    return count;
  }

  void reject(const std::string& why) {
    reply_.problem = fmt::format("its standard output isn't a reply: {}", why);
  }

  ShellProcess& shell_;
  std::span<const char> unsent_;
  const std::function<std::size_t(const std::string&)>& body_size_;
  std::vector<char>& body_;
  WorkerReply reply_;
  bool has_header_ = false;
  bool is_closed_ = false;
  std::size_t num_read_ = 0;
};

}  // namespace

WorkerProcess::WorkerProcess(const ShellCommand& command)
    : shell_(command, ShellProcess::Streams::stdin_and_stdout) {
  std::signal(SIGPIPE, SIG_IGN);  // that a program reads no more is an error of write()
}

WorkerReply WorkerProcess::exchange(std::span<const char> request, double time_limit,
                                    const std::function<std::size_t(const std::string&)>& body_size,
                                    std::vector<char>& body) {
  Exchange exchange(shell_, request, body_size, body);
  if (num_requests_++ > 0) exchange.require_silence();
  return exchange.run(time_limit);
}

}  // namespace npdr::pipeline
