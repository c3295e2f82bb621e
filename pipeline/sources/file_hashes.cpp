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

void FileHashes::require_unchanged() const {
  for (const auto& [name, stamp] : stamps_) {
    const std::filesystem::path path = folder_ / name;
    std::error_code error;
    const bool is_there = std::filesystem::is_regular_file(path, error);
    if (is_there && (stamp_of(path) == stamp || file_hash(path) == hashes_.at(name))) continue;
    throw Error(fmt::format(
        "{} {} since this began: rows that were simulated with it meanwhile are thrown away; run "
        "again, with the file as it was to go on, or as it is now to begin anew",
        path.string(), is_there ? "was edited" : "is gone"));
  }
}

// Of a file that isn't there: zeros.
FileHashes::Stamp FileHashes::stamp_of(const std::filesystem::path& path) {
  std::error_code error;
  Stamp stamp;
  stamp.time = std::filesystem::last_write_time(path, error);
  stamp.size = std::filesystem::file_size(path, error);
  return stamp;
}

}  // namespace npdr::pipeline
