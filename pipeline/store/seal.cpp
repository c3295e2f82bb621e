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
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr std::string_view kBegin = "npdr xxh3-128 ";
constexpr std::size_t kSealBytes = kBegin.size() + 32 + 1;

// An open file; closes on destruction.
class OpenFile {
 public:
  OpenFile(const std::filesystem::path& path, int flags, const std::filesystem::path& shown_as)
      : shown_as_(shown_as), descriptor_(::open(path.c_str(), flags | O_CLOEXEC)) {}
  ~OpenFile() {
    if (is_open()) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool is_open() const { return descriptor_ >= 0; }

  // Of a regular file; others have none.
  std::size_t size() const {
    struct stat status = {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) return 0;
    return static_cast<std::size_t>(status.st_size);
  }

  // Up to `count` bytes from `at` on; none where the file ends.
  std::size_t read(char* bytes, std::size_t count, std::size_t at) const {
    for (;;) {
      const ssize_t done = ::pread(descriptor_, bytes, count, static_cast<off_t>(at));
      if (done >= 0) return static_cast<std::size_t>(done);
      if (errno != EINTR) throw_file_error(shown_as_, "be read", errno);
    }
  }

  void append(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t done = ::write(descriptor_, text.data(), text.size());
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) throw_file_error(shown_as_, "be given its checksum", errno);
      text.remove_prefix(static_cast<std::size_t>(done));
    }
  }

 private:
  const std::filesystem::path& shown_as_;
  int descriptor_;
};

// The seal of a file's first `size` bytes.
std::string seal_of(const OpenFile& file, std::size_t size) {
  std::vector<char> buffer(std::size_t{1} << 20);
  Hasher hasher;
  for (std::size_t at = 0; at < size;) {
    const std::size_t count = file.read(buffer.data(), std::min(buffer.size(), size - at), at);
    if (count == 0) break;  // somebody has cut it meanwhile: the seal won't fit
    hasher.add_bytes(buffer.data(), count);
    at += count;
  }
  return std::string(kBegin) + hasher.hex() + "\n";
}

}  // namespace

void seal_file(const std::filesystem::path& path, const std::filesystem::path& shown_as) {
  const OpenFile file(path, O_RDWR | O_APPEND, shown_as);
  if (!file.is_open()) throw_file_error(shown_as, "be given its checksum", errno);
  file.append(seal_of(file, file.size()));
}

bool has_intact_seal(const std::filesystem::path& path) {
  const OpenFile file(path, O_RDONLY, path);
  if (!file.is_open() || file.size() < kSealBytes) return false;
  const std::size_t sealed = file.size() - kSealBytes;
  std::string found(kSealBytes, '\0');
  file.read(found.data(), found.size(), sealed);
  if (!found.starts_with(kBegin)) return false;
  if (found == seal_of(file, sealed)) return true;
  throw InputError(path.string() + ": is damaged: its bytes don't match its checksum");
}

}  // namespace npdr::pipeline
