#include "pipeline/store/seal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <string_view>
#include <vector>

#include "core/file_error.h"
#include "core/open_file.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr std::string_view kBegin = "npdr xxh3-128 ";
constexpr std::size_t kSealBytes = kBegin.size() + 32 + 1;

constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";

// Size of a regular file; 0 for others.
std::size_t size_of(const OpenFile& file) {
  struct stat status = {};
  if (::fstat(file.value(), &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  return static_cast<std::size_t>(status.st_size);
}

// Exactly `count` bytes from `at` on.
void read(const OpenFile& file, const std::filesystem::path& shown_as, char* bytes,
          std::size_t count, std::size_t at) {
  while (count > 0) {
    const ssize_t done = ::pread(file.value(), bytes, count, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) throw_read_error(shown_as, errno);
    if (done == 0) throw Error(shown_as.string() + ": got shorter while it was read; try again");
    bytes += done;
    count -= static_cast<std::size_t>(done);
    at += static_cast<std::size_t>(done);
  }
}

// The seal of a file's first `size` bytes.
std::string seal_of(const OpenFile& file, const std::filesystem::path& shown_as, std::size_t size) {
  std::vector<char> buffer(std::size_t{1} << 20);
  Hasher hasher;
  for (std::size_t at = 0; at < size;) {
    const std::size_t count = std::min(buffer.size(), size - at);
    read(file, shown_as, buffer.data(), count, at);
    hasher.add_bytes(buffer.data(), count);
    at += count;
  }
  return std::string(kBegin) + hasher.hex() + "\n";
}

}  // namespace

void seal_file(const std::filesystem::path& path, const std::filesystem::path& shown_as) {
  const OpenFile file(path, O_RDWR | O_APPEND);
  if (!file.is_open() || !file.write(seal_of(file, shown_as, size_of(file)))) {
    throw_file_error(shown_as, "be given its checksum", errno);
  }
}

// A pipe would be waited for without end.
constexpr int kReading = O_RDONLY | O_NONBLOCK;

bool has_intact_seal(const std::filesystem::path& path) {
  const OpenFile file(path, kReading);
  if (!file.is_open() && errno != ENOENT && errno != ENOTDIR) throw_read_error(path, errno);
  if (!file.is_open() || size_of(file) < kSealBytes) return false;
  const std::size_t sealed = size_of(file) - kSealBytes;
  std::string found(kSealBytes, '\0');
  read(file, path, found.data(), found.size(), sealed);
  if (!found.starts_with(kBegin)) return false;
  if (found == seal_of(file, path, sealed)) return true;
  throw DamagedFile(path.string() + ": is damaged: its bytes don't match its checksum");
}

bool is_damaged(const std::filesystem::path& path) {
  try {
    if (has_intact_seal(path)) return false;
  } catch (const DamagedFile&) {
    return true;
  }
  const OpenFile file(path, kReading);
  if (!file.is_open() || !std::filesystem::is_regular_file(path)) return false;
  std::string begin(std::min(kHdf5.size(), size_of(file)), '\0');
  read(file, path, begin.data(), begin.size(), 0);
  return kHdf5.starts_with(begin);
}

}  // namespace npdr::pipeline
