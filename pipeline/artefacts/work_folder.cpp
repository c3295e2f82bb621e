#include "pipeline/artefacts/work_folder.h"

#include <system_error>

#include "core/atomic_file.h"
#include "core/file_error.h"

namespace npdr::pipeline {

namespace fs = std::filesystem;

fs::path WorkFolder::artefact(const std::string& stage, const std::string& key) const {
  return root_ / ".cache" / stage / (key + ".h5");
}

fs::path WorkFolder::beside(const fs::path& other, const std::string& stage,
                            const std::string& key) {
  return other.parent_path().parent_path() / stage / (key + ".h5");
}

fs::path WorkFolder::checkpoint(const std::string& stage, const std::string& key) const {
  return root_ / ".cache" / stage / (key + ".checkpoint.h5");
}

fs::path WorkFolder::asked_rows(const std::string& key) const {
  return root_ / ".cache" / "infer" / (key + ".rows");
}

fs::path WorkFolder::shard(const std::string& key, RowRange rows) const {
  const std::string name =
      "rows-" + std::to_string(rows.begin) + "-" + std::to_string(rows.end) + ".h5";
  return root_ / ".cache" / "simulate" / key / name;
}

void make_link(const fs::path& target, const fs::path& link) {
  std::error_code error;
  fs::create_directories(link.parent_path(), error);
  const fs::path relative = fs::relative(target, link.parent_path(), error);
  if (fs::is_symlink(link) && fs::read_symlink(link, error) == relative) return;
  // A link is renamed into place, so that it never points to nothing.
  const fs::path temporary = temporary_name(link);
  remove_stale_temporaries_once(link.parent_path());
  fs::create_symlink(relative, temporary, error);
  if (!error) fs::rename(temporary, link, error);
  if (error) throw_file_error(link, "be made a link", error.value());
}

}  // namespace npdr::pipeline
