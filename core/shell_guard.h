/// Parents of shells, which nothing that a shell starts survives.
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>

namespace npdr {

/// The shell's parent, and that of all that it leaves behind in whatever session or group: a child
/// process that ends them when this object goes, or this process, such as by kill -9. It learns
/// that from the end of a pipe which only this process has open for writing.
class ShellGuard {
 public:
  /// `become` makes a shell of a new process, in a group of its own, without allocating, and
  /// doesn't return. Throws Error when there can be no process.
  explicit ShellGuard(const std::function<void()>& become);
  ShellGuard(const ShellGuard&) = delete;
  ShellGuard& operator=(const ShellGuard&) = delete;
  ~ShellGuard();

  /// Number of the shell, and of its group, as long as this object is there.
  pid_t shell() const { return shell_; }

  /// Exit status of the shell, 128 + signal number when a signal ended it; none: it runs.
  std::optional<int> exit_status();

 private:
  void end();
  std::optional<int> heard() const;

  pid_t process_ = -1;
  int control_ = -1;
  int report_ = -1;
  pid_t shell_ = -1;
  std::optional<int> exit_status_;
};

}  // namespace npdr
