/// Lines of CSV files.
#pragma once

#include <string>
#include <vector>

namespace npdr::pipeline {

/// How a file separates its columns and writes its numbers.
struct CsvFormat {
  char delimiter = ',';
  bool decimal_comma = false;  ///< 1,5 is one and a half; the delimiter is another then
};

/// The format of --delimiter and --decimal-comma: `delimiter` is a comma, ';', '|' or "tab". Throws
/// InputError for another, and for commas that would both separate columns and begin decimals.
CsvFormat parse_csv_format(const std::string& delimiter, bool decimal_comma);

/// "commas", "';'", "tabs".
std::string delimiter_name(char delimiter);

/// The fields of a line, trimmed (RFC 4180, except that a field can't hold a line break). Throws
/// InputError, which begins with `where`, when the last quote isn't closed.
std::vector<std::string> csv_fields(const std::string& line, const std::string& where,
                                    char delimiter = ',');

/// The end of a message about lines that can't be read in this format: what they look like, and the
/// options of the command line that read them so. Empty when they don't look like another format.
std::string format_hint(const std::string& lines, const CsvFormat& format);

}  // namespace npdr::pipeline
