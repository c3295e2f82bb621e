/// Files that rows depend on, held against what they were when they were read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace npdr::pipeline {

class FileHashes {
 public:
  /// Reads files by their names in `folder`. Throws InputError for one that can't be read.
  FileHashes(const std::vector<std::string>& names, const std::filesystem::path& folder);

  /// Hashes by name.
  const std::map<std::string, std::string>& by_name() const { return hashes_; }

  /// Throws Error with the first file that isn't what it was: rows that are simulated with it
  /// belong to another key. Reads only files whose time or size has changed; what was edited and
  /// put back is what it was. A file that can't be read just now is looked at the next time.
  void require_unchanged();

 private:
  struct Stamp {
    std::filesystem::file_time_type time;
    std::uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };
  static Stamp stamp_of(const std::filesystem::path& path);

  std::filesystem::path folder_;
  std::map<std::string, std::string> hashes_;
  std::map<std::string, Stamp> stamps_;
};

}  // namespace npdr::pipeline
