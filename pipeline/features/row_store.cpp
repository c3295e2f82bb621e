#include "pipeline/features/row_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/atomic_file.h"
#include "core/error.h"

namespace npdr::pipeline {
namespace {

constexpr std::size_t kLargestInMemory = std::size_t{512} << 20;  // [bytes]

[[noreturn]] void fail(const std::string& what) {
  throw Error("temporary rows of features: can't " + what + ": " + std::strerror(errno) +
              "; free some space or choose another --work folder");
}

}  // namespace

RowStore::RowStore(Index num_rows, Index width, const std::filesystem::path& folder)
    : num_rows_(num_rows), width_(width) {
  const auto count = static_cast<std::size_t>(num_rows * width);
  if (count * sizeof(float) <= kLargestInMemory) {
    memory_.resize(count);
    return;
  }
  make_folder(folder);
  // Named like all temporaries, in case that the process is killed before the name is gone.
  const std::filesystem::path name = temporary_name(folder / "rows");
  file_ = open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file_ < 0) fail("make '" + name.string() + "'");
  unlink(name.c_str());
  // Claims the space now, rather than failing half way.
  do {
    errno = posix_fallocate(file_, 0, static_cast<off_t>(count * sizeof(float)));
  } while (errno == EINTR);
  if (errno != 0) fail("reserve " + std::to_string((count * sizeof(float)) >> 20) + " MiB");
}

RowStore::~RowStore() {
  if (file_ >= 0) close(file_);
}

void RowStore::write(Index row, std::span<const float> values) {
  if (file_ < 0) {
    std::copy(values.begin(), values.end(), memory_.begin() + row * width_);
    return;
  }
  const auto at = static_cast<off_t>(static_cast<std::size_t>(row * width_) * sizeof(float));
  if (pwrite(file_, values.data(), values.size_bytes(), at) !=
      static_cast<ssize_t>(values.size_bytes())) {
    fail("write");
  }
}

void RowStore::read(Index row, std::span<float> values) const {
  if (file_ < 0) {
    std::copy_n(memory_.begin() + row * width_, width_, values.begin());
    return;
  }
  const auto at = static_cast<off_t>(static_cast<std::size_t>(row * width_) * sizeof(float));
  if (pread(file_, values.data(), values.size_bytes(), at) !=
      static_cast<ssize_t>(values.size_bytes())) {
    fail("read");
  }
}

}  // namespace npdr::pipeline
