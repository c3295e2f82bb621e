/// A limit on how long a library's functions take.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <thread>

namespace npdr::sim {

/// Watches calls from a thread of its own. Nothing can interrupt a library that loops, and its
/// thread can't be ended: a call that takes longer than the limit ends the program with exit status
/// 1, and a message on stderr.
class CallWatch {
 public:
  /// What the message says of the call beside its function, "" for nothing.
  using Words = std::function<std::string()>;

  /// `time_limit` > 0 [s] of each call; `file`: the library's, which the message names.
  CallWatch(std::filesystem::path file, double time_limit);

  /// A call that runs as long as this lives. `words` is asked by the watch's thread, and only if
  /// the call takes too long.
  class Call {
   public:
    Call(CallWatch& watch, const char* function, Words words);
    ~Call();
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

   private:
    friend class CallWatch;
    using Clock = std::chrono::steady_clock;

    CallWatch& watch_;
    const char* function_;
    Words words_;
    Clock::time_point start_ = Clock::now();
    std::list<const Call*>::iterator place_;
  };

 private:
  void look(const std::stop_token& stop);
  [[noreturn]] void end_program(const Call& call) const;

  std::filesystem::path file_;
  std::chrono::duration<double> time_limit_;
  std::mutex mutex_;
  std::list<const Call*> running_;  // in the order of their starts
  std::jthread thread_;             // last: it uses what is above
};

}  // namespace npdr::sim
