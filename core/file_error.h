/// Failures of the file system, in words that say what to do.
#pragma once

#include <filesystem>
#include <string>

namespace npdr {

/// Advice on the error number of a failed system call; "" when there is nothing to advise.
std::string file_advice(int error_number);

/// "path: can't action: reason; advice".
std::string file_error_text(const std::filesystem::path& path, const std::string& action,
                            int error_number);

/// The same for a file that can't be read: what would let it be.
std::string read_advice(int error_number);
[[noreturn]] void throw_read_error(const std::filesystem::path& path, int error_number);

/// Throws Error with that text.
[[noreturn]] void throw_file_error(const std::filesystem::path& path, const std::string& action,
                                   int error_number);

}  // namespace npdr
