/// Lines at the end of a terminal that are written anew in their place. None is ever wider than the
/// terminal: one that wrapped couldn't be taken back.
#pragma once

#include <unistd.h>

#include <string>
#include <vector>

#include "pipeline/process/fitted_text.h"

namespace npdr::pipeline {

/// "[#####.....]" of `width` characters; share in [0, 1].
std::string bar(double share, int width);

/// The lines of this process on stderr. Never throws: a terminal that was closed ends no run. Not
/// thread-safe.
class LiveLines {
 public:
  LiveLines();
  /// Ends the last line.
  ~LiveLines();
  LiveLines(const LiveLines&) = delete;
  LiveLines& operator=(const LiveLines&) = delete;

  /// Whether stderr is a terminal; elsewhere nothing can be taken back, and show() does nothing.
  bool is_terminal() const { return is_terminal_; }
  /// As it is now: people change it.
  TerminalSize size() const { return terminal_size(STDERR_FILENO).value_or(TerminalSize{}); }

  /// Writes these in place of those that are shown.
  void show(const std::vector<std::string>& lines);
  /// Takes them back: what is printed next stands in their place.
  void clear();

 private:
  std::string back_to_the_first() const;

  bool is_terminal_;
  std::size_t num_shown_ = 0;
};

}  // namespace npdr::pipeline
