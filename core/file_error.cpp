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
      return "; free some space there (df), or files (df -i), or choose another folder";
    case EFBIG:
      return "; raise the limit on the size of a file (ulimit -f)";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; make the folder writable or choose another one";
    case ELOOP:
      return "; remove the link there, which leads to itself or is in the way";
    default:
      return "";
  }
}

std::string read_advice(int error_number) {
  switch (error_number) {
    case EACCES:
    case EPERM:
      return "; may you read it?";
    case EMFILE:
    case ENFILE:
      return "; raise the limit on open files (ulimit -n)";
    case EAGAIN:
    case EIO:
    case ESTALE:
    case ETIMEDOUT:
      return "; try again later";
    default:
      return "";
  }
}

void throw_read_error(const std::filesystem::path& path, int error_number) {
  throw Error(fmt::format("{}: can't be read: {}{}", path.string(),
                          std::generic_category().message(error_number),
                          read_advice(error_number)));
}

std::string file_error_text(const std::filesystem::path& path, const std::string& action,
                            int error_number) {
  return fmt::format("{}: can't {}: {}{}", path.string(), action,
                     std::generic_category().message(error_number), file_advice(error_number));
}

void throw_file_error(const std::filesystem::path& path, const std::string& action,
                      int error_number) {
  throw Error(file_error_text(path, action, error_number));
}

}  // namespace npdr
