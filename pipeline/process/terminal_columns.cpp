#include "pipeline/process/terminal_columns.h"

#include <sys/ioctl.h>
#include <unistd.h>

namespace npdr::pipeline {

std::optional<int> terminal_columns() {
  winsize found = {};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &found) != 0 || found.ws_col < 1) return std::nullopt;
  return found.ws_col;
}

}  // namespace npdr::pipeline
