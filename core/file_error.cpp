#include "core/file_error.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include "core/error.h"

namespace npdr {

std::string file_advice(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "; free some space there or choose another folder";
    case EFBIG:
      return "; raise the limit on the size of a file (ulimit -f)";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; make the folder writable or choose another one";
    default:
      return "";
  }
}

void throw_file_error(const std::filesystem::path& path, const std::string& action,
                      int error_number) {
  throw Error(fmt::format("{}: can't {}: {}{}", path.string(), action,
                          std::generic_category().message(error_number),
                          file_advice(error_number)));
}

}  // namespace npdr
