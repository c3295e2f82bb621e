#include "core/pipe.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace npdr {

Pipe::Pipe() {
  if (::pipe2(ends_.data(), O_CLOEXEC) == 0) return;
  throw Error("can't make a pipe: " + std::generic_category().message(errno));
}

Pipe::~Pipe() {
  for (const int end : ends_) {
    if (end >= 0) ::close(end);
  }
}

void Pipe::close_write_end() { ::close(std::exchange(ends_[1], -1)); }

int Pipe::take(int end) {
  ::fcntl(end, F_SETFL, O_NONBLOCK);
  *std::ranges::find(ends_, end) = -1;
  return end;
}

}  // namespace npdr
