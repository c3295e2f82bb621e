#include "pipeline/process/live_lines.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace npdr::pipeline {

std::string bar(double share, int width) {
  const auto inside = static_cast<std::size_t>(std::max(0, width - 2));
  const auto full = static_cast<std::size_t>(
      std::floor(std::clamp(share, 0.0, 1.0) * static_cast<double>(inside)));
  return "[" + std::string(full, '#') + std::string(inside - full, '.') + "]";
}

LiveLines::LiveLines() : is_terminal_(isatty(STDERR_FILENO) != 0) {}

LiveLines::~LiveLines() {
  if (num_shown_ > 0) std::fputc('\n', stderr);
}

std::string LiveLines::back_to_the_first() const {
  std::string text = num_shown_ > 0 ? "\r" : "";
  for (std::size_t line = 1; line < num_shown_; ++line) text += "\033[A";
  return text;
}

void LiveLines::show(const std::vector<std::string>& lines) {
  if (!is_terminal_) return;
  const int columns = size().columns - 1;  // the last one may wrap already
  std::string text = back_to_the_first();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += (i > 0 ? "\n" : "") + fitted(lines[i], columns) + "\033[K";
  }
  num_shown_ = lines.size();
  std::fputs((text + "\033[J").c_str(), stderr);
  std::fflush(stderr);
}

void LiveLines::clear() {
  if (num_shown_ == 0) return;
  std::fputs((back_to_the_first() + "\033[J").c_str(), stderr);
  num_shown_ = 0;
}

}  // namespace npdr::pipeline
