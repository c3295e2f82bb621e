#include "analysis/text_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/error.h"

namespace npdr::analysis {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw Error(path.string() + ": " + what + ": " + std::strerror(errno));
}

// A file descriptor that is closed, and its file removed unless kept, whatever happens.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path)
      : path_(std::move(path)),
        descriptor_(open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail(path_, "can't be written");
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!path_.empty()) unlink(path_.c_str());
  }

  void write_all(std::string_view text) {
    while (!text.empty()) {
      const ssize_t count = write(descriptor_, text.data(), text.size());
      if (count < 0 && errno != EINTR) fail(path_, "can't be written");
      if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  void rename_to(const std::filesystem::path& path) {
    if (fsync(descriptor_) != 0) fail(path_, "can't be flushed");
    if (rename(path_.c_str(), path.c_str()) != 0) fail(path, "can't be replaced");
    path_.clear();
  }

 private:
  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace

void write_text_file(const std::filesystem::path& path, std::string_view text) {
  if (path.has_parent_path()) {
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(), error);
    if (error) throw Error(path.parent_path().string() + ": " + error.message());
  }
  TemporaryFile temporary(path.string() + ".tmp" + std::to_string(getpid()));
  temporary.write_all(text);
  temporary.rename_to(path);
}

void check_file_stem(std::string_view kind, std::string_view stem) {
  const auto allowed = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  if (!stem.empty() && std::all_of(stem.begin(), stem.end(), allowed)) return;
  throw InputError(std::string(kind) + ": name '" + std::string(stem) +
                   "', must be letters, digits, '_' and '-'");
}

std::string read_text_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, "can't be read");
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) fail(path, "can't be read");
  return text;
}

}  // namespace npdr::analysis
