#include "core/open_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace npdr {

OpenFile::OpenFile(const std::filesystem::path& path, int flags, unsigned mode)
    : value_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}

OpenFile::~OpenFile() {
  if (is_open()) ::close(value_);
}

bool OpenFile::write(std::string_view text) const {
  while (!text.empty()) {
    const ssize_t count = ::write(value_, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool OpenFile::close() { return ::close(std::exchange(value_, -1)) == 0; }

}  // namespace npdr
