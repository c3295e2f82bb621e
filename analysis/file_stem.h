/// Names that are safe parts of a file's name.
#pragma once

#include <string_view>

namespace npdr::analysis {

/// Throws InputError unless `stem` is made of letters, digits, '_' and '-', so that it is a safe
/// part of a file's name; `kind` ("table") begins the message.
void check_file_stem(std::string_view kind, std::string_view stem);

}  // namespace npdr::analysis
