#include "core/temporary_folder.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"

namespace npdr {

TemporaryFolder::TemporaryFolder(const std::string& name, const std::string& purpose) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  if (error) {
    std::string found = "TMPDIR = ''";
    // The last one counts.
    for (const std::string variable : {"TEMPDIR", "TEMP", "TMP", "TMPDIR"}) {
      const char* const value = std::getenv(variable.c_str());
      if (value != nullptr) found = variable + " = '" + value + "'";
    }
    throw InputError(found + ", must be an existing folder: " + purpose);
  }
  remove_stale_temporaries_once(parent);
  do {
    path_ = temporary_name(std::filesystem::absolute(parent) / name);
  } while (mkdir(path_.c_str(), 0700) != 0 && errno == EEXIST);
  const int reason = errno;
  std::error_code unreadable;
  if (!std::filesystem::is_directory(path_, unreadable)) {
    throw_file_error(path_, "make this folder", reason);
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace npdr
