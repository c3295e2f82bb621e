/// A file of the operating system, held open.
#pragma once

#include <filesystem>
#include <string_view>

namespace npdr {

/// Closes on destruction. What it can't open isn't open: the caller asks, and errno says why.
class OpenFile {
 public:
  /// `flags` as of open(2); O_CLOEXEC is added. New files get `mode`, less the process's mask.
  OpenFile(const std::filesystem::path& path, int flags, unsigned mode = 0666);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool is_open() const { return value_ >= 0; }
  int value() const { return value_; }

  /// Writes all of the text. False: errno says why.
  bool write(std::string_view text) const;
  /// False: errno says why, and what was written may be lost.
  bool close();

 private:
  int value_;
};

}  // namespace npdr
