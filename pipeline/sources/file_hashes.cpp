#include "pipeline/sources/file_hashes.h"

#include <fmt/format.h>

#include <system_error>

#include "core/error.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {

FileHashes::FileHashes(const std::vector<std::string>& names, const std::filesystem::path& folder)
    : folder_(folder) {
  for (const std::string& name : names) {
    stamps_[name] = stamp_of(folder / name);  // first: an edit in between is looked at again
    hashes_[name] = file_hash(folder / name);
  }
}

void FileHashes::require_unchanged() {
  for (auto& [name, stamp] : stamps_) {
    const std::filesystem::path path = folder_ / name;
    std::error_code error;
    const bool is_gone = !std::filesystem::exists(path, error);
    if (error) continue;
    const Stamp now = stamp_of(path);
    if (!is_gone && now == stamp) continue;
    if (is_gone || file_hash(path) != hashes_.at(name)) {
      throw Error(fmt::format(
          "{} {} since this began: rows that were simulated with it meanwhile are thrown away; "
          "run again, with the file as it was to go on, or as it is now to begin anew",
          path.string(), is_gone ? "is gone" : "was edited"));
    }
    stamp = now;
  }
}

FileHashes::Stamp FileHashes::stamp_of(const std::filesystem::path& path) {
  std::error_code ignored;
  return {std::filesystem::last_write_time(path, ignored),
          std::filesystem::file_size(path, ignored)};
}

}  // namespace npdr::pipeline
