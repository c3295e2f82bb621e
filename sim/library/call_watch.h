/// A limit on how long a library's functions take.
#pragma once

#include <filesystem>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <thread>

namespace npdr::sim {

/// Watches calls from a thread of its own; const and other calls are thread-safe. Nothing can
/// interrupt a library that loops, and its thread can't be ended: a call that takes longer than the
/// limit ends the program, up to a second later.
class CallWatch {
 public:
  /// What the message says of the call beside its function; "" for nothing.
  using Words = std::function<std::string()>;
  /// Says why the program ends, and ends it; with exit status 1 if it returns.
  using End = std::function<void(const std::string& message)>;
  /// An End that prints the message on stderr.
  static void print(const std::string& message);

  /// `time_limit` > 0 [s] of each call, without time in which the process was stopped. The message
  /// is about `file`, the library's.
  CallWatch(std::filesystem::path file, double time_limit, End end);

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

    CallWatch& watch_;
    const char* function_;
    Words words_;
    double start_ = 0.0;
    std::list<const Call*>::iterator place_;
  };

 private:
  void look(const std::stop_token& stop);
  [[noreturn]] void end_program(const Call& call) const;

  std::filesystem::path file_;
  double time_limit_;
  End end_;
  std::mutex mutex_;
  double now_ = 0.0;                // [s]
  std::list<const Call*> running_;  // in the order of their starts
  std::jthread thread_;             // last: it uses what is above
};

}  // namespace npdr::sim
