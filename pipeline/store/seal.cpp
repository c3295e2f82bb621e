#include "pipeline/store/seal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/file_error.h"
#include "core/open_file.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr std::string_view kBegin = "npdr xxh3-128 ";
constexpr std::size_t kSealBytes = kBegin.size() + 32 + 1;

// Size of a regular file; 0 for others.
std::size_t size_of(const OpenFile& file) {
  struct stat status = {};
  if (::fstat(file.value(), &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  return static_cast<std::size_t>(status.st_size);
}

// Up to `count` bytes from `at` on; none where the file ends.
std::size_t read(const OpenFile& file, const std::filesystem::path& shown_as, char* bytes,
                 std::size_t count, std::size_t at) {
  for (;;) {
    const ssize_t done = ::pread(file.value(), bytes, count, static_cast<off_t>(at));
    if (done >= 0) return static_cast<std::size_t>(done);
    if (errno != EINTR) throw_file_error(shown_as, "be read", errno);
  }
}

// The seal of a file's first `size` bytes.
std::string seal_of(const OpenFile& file, const std::filesystem::path& shown_as, std::size_t size) {
  std::vector<char> buffer(std::size_t{1} << 20);
  Hasher hasher;
  for (std::size_t at = 0; at < size;) {
    const std::size_t count =
        read(file, shown_as, buffer.data(), std::min(buffer.size(), size - at), at);
    if (count == 0) break;  // somebody has cut it meanwhile: the seal won't fit
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

bool has_intact_seal(const std::filesystem::path& path) {
  const OpenFile file(path, O_RDONLY);
  if (!file.is_open() || size_of(file) < kSealBytes) return false;
  const std::size_t sealed = size_of(file) - kSealBytes;
  std::string found(kSealBytes, '\0');
  read(file, path, found.data(), found.size(), sealed);
  if (!found.starts_with(kBegin)) return false;
  if (found == seal_of(file, path, sealed)) return true;
  throw InputError(path.string() + ": is damaged: its bytes don't match its checksum");
}

}  // namespace npdr::pipeline
