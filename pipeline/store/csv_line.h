/// Lines of CSV files.
#pragma once

#include <string>
#include <vector>

namespace npdr::pipeline {

/// The fields of a line, trimmed (RFC 4180, except that a field can't hold a line break). Throws
/// InputError, which begins with `where`, when the last quote isn't closed.
std::vector<std::string> csv_fields(const std::string& line, const std::string& where);

}  // namespace npdr::pipeline
