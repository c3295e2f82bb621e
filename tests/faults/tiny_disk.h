/// A file system of a few megabytes, for tests of what happens when it is full or read-only.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>

namespace npdr {

/// A tmpfs that only this process and its children see. Needs the rights of root: ask is_there().
class TinyDisk {
 public:
  /// `options` as of mount(8), such as "size=8m,nr_inodes=100".
  TinyDisk(std::filesystem::path folder, const std::string& options) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
    is_there_ = unshare(CLONE_NEWNS) == 0 &&
                mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                mount("tmpfs", folder_.c_str(), "tmpfs", 0, options.c_str()) == 0;
    if (!is_there_) why_ = std::strerror(errno);
  }
  ~TinyDisk() {
    if (is_there_) umount2(folder_.c_str(), MNT_DETACH);
  }
  TinyDisk(const TinyDisk&) = delete;
  TinyDisk& operator=(const TinyDisk&) = delete;

  bool is_there() const { return is_there_; }
  std::string why_not() const { return "can't mount a tmpfs: " + why_; }

  void make_read_only() const {
    mount(nullptr, folder_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr);
  }

  /// Takes all space but for `bytes`.
  void leave(std::uintmax_t bytes) const {
    free_all();
    const std::uintmax_t space = std::filesystem::space(folder_).available;
    const int file = open(filler().c_str(), O_WRONLY | O_CREAT, 0600);
    [[maybe_unused]] const int error =
        posix_fallocate(file, 0, static_cast<off_t>(space - std::min(space, bytes)));
    close(file);
  }
  void free_all() const { std::filesystem::remove(filler()); }

 private:
  std::filesystem::path filler() const { return folder_ / "filler"; }

  std::filesystem::path folder_;
  bool is_there_ = false;
  std::string why_;
};

}  // namespace npdr
