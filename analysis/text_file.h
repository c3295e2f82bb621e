/// Text files that are complete or absent.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace npdr::analysis {

/// Writes `text` to a temporary file beside `path`, flushes it to the disk and renames it to
/// `path`. Makes the folder when it is missing. Throws Error with the path and the reason.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// Throws InputError unless `stem` is made of letters, digits, '_' and '-', so that it is a safe
/// part of a file's name; `kind` ("table") begins the message.
void check_file_stem(std::string_view kind, std::string_view stem);

/// The whole file. Throws Error with the path and the reason.
std::string read_text_file(const std::filesystem::path& path);

}  // namespace npdr::analysis
