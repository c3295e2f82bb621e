/// Folders for files that nobody else needs.
#pragma once

#include <filesystem>
#include <string>

namespace npdr {

/// A new folder of this process and user alone, below the system's folder of temporary files
/// (TMPDIR); removed with all that is in it. What a dead process of this host left there goes, too.
class TemporaryFolder {
 public:
  /// `name` is a part of its name. Throws InputError where there are no temporary files to be:
  /// `purpose` says what they are; Error when the folder can't be made.
  TemporaryFolder(const std::string& name, const std::string& purpose);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// Absolute.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace npdr
