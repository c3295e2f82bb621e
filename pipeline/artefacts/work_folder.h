/// Where things lie: the cache of artefacts, and the readable folder of a study
/// (docs/architecture.md). The file tree is the only state: there is no database or controller.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "core/types.h"

namespace npdr::pipeline {

/// Rows [begin, end) of a simulation.
struct RowRange {
  Index begin = 0;
  Index end = 0;

  Index size() const { return end - begin; }
};

class WorkFolder {
 public:
  /// `root` as the user gave it, such as "runs".
  explicit WorkFolder(std::filesystem::path root) : root_(std::move(root)) {}

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path artefact(const std::string& stage, const std::string& key) const {
    return root_ / ".cache" / stage / (key + ".h5");
  }
  /// The artefact in the cache that `other`, another artefact, lies in.
  static std::filesystem::path beside(const std::filesystem::path& other, const std::string& stage,
                                      const std::string& key) {
    return other.parent_path().parent_path() / stage / (key + ".h5");
  }
  /// File that an interrupted stage goes on from.
  std::filesystem::path checkpoint(const std::string& stage, const std::string& key) const {
    return root_ / ".cache" / stage / (key + ".checkpoint.h5");
  }
  /// Folder of the rows that a refinement asks its helpers for (asked_rows_file.h).
  std::filesystem::path asked_rows(const std::string& key) const {
    return root_ / ".cache" / "infer" / (key + ".rows");
  }
  /// These rows of the simulation `key`.
  std::filesystem::path shard(const std::string& key, RowRange rows) const {
    return root_ / ".cache" / "simulate" / key / fmt::format("rows-{}-{}.h5", rows.begin, rows.end);
  }
  std::filesystem::path study(const std::string& name) const { return root_ / name; }

 private:
  std::filesystem::path root_;
};

/// Makes or renews the relative link `link` to `target`. Throws Error.
void make_link(const std::filesystem::path& target, const std::filesystem::path& link);

}  // namespace npdr::pipeline
