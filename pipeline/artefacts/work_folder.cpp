#include "pipeline/artefacts/work_folder.h"

#include <system_error>

#include "core/atomic_file.h"
#include "core/file_error.h"

namespace npdr::pipeline {

namespace fs = std::filesystem;

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
