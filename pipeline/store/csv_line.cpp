#include "pipeline/store/csv_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// Whether `mark` stands between two digits.
bool splits_a_number(const std::string& text, char mark) {
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i] == mark && is_digit(text[i - 1]) && is_digit(text[i + 1])) return true;
  }
  return false;
}

// Another delimiter that the lines hold; 0: none, or they hold the right one, too.
char other_delimiter(const std::string& lines, char delimiter) {
  const bool has_own = lines.find(delimiter) != std::string::npos;
  for (const char other : {';', '\t', '|'}) {
    // Commas may be those of decimals.
    const bool is_hidden = has_own && delimiter != ',';
    if (other != delimiter && !is_hidden && lines.find(other) != std::string::npos) return other;
  }
  return delimiter != ',' && !has_own && lines.find(',') != std::string::npos ? ',' : '\0';
}

std::string option_of(char delimiter) {
  return delimiter == '\t' ? "--delimiter tab" : fmt::format("--delimiter '{}'", delimiter);
}

}  // namespace

CsvFormat parse_csv_format(const std::string& delimiter, bool decimal_comma) {
  const bool is_known = delimiter == "," || delimiter == ";" || delimiter == "|" ||
                        delimiter == "tab" || delimiter == "\t";
  if (!is_known) {
    throw InputError("--delimiter = " + quoted(delimiter) + ", must be ',', ';', '|' or tab");
  }
  const CsvFormat format = {delimiter == "tab" ? '\t' : delimiter.front(), decimal_comma};
  if (decimal_comma && format.delimiter == ',') {
    throw InputError(
        "--decimal-comma: commas can't separate the columns, too; say what does, such as "
        "--delimiter ';'");
  }
  return format;
}

std::string delimiter_name(char delimiter) {
  if (delimiter == ',') return "commas";
  return delimiter == '\t' ? "tabs" : fmt::format("'{}'", delimiter);
}

std::vector<std::string> csv_fields(const std::string& line, const std::string& where,
                                    char delimiter) {
  std::vector<std::string> fields(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool quote = line[i] == '"';
    if (inside && quote && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[i++];
    } else if (quote) {
      inside = !inside;
    } else if (line[i] == delimiter && !inside) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  if (inside) {
    throw InputError(fmt::format("{}: column {} has no closing quote", where, fields.size()));
  }
  std::ranges::transform(fields, fields.begin(), trimmed);
  return fields;
}

std::string format_hint(const std::string& lines, const CsvFormat& format) {
  const char other = other_delimiter(lines, format.delimiter);
  if (other == ',') return "; its columns look separated by commas: leave out --delimiter";
  const char delimiter = other == '\0' ? format.delimiter : other;
  const bool has_commas = delimiter != ',' && splits_a_number(lines, ',');
  std::vector<std::string> looks, options;
  if (other != '\0') {
    looks.push_back("its columns look separated by " + delimiter_name(other));
    options.push_back(option_of(other));
  }
  if (has_commas && !format.decimal_comma) {
    looks.emplace_back("its decimals look written with a comma");
    options.emplace_back("--decimal-comma");
  }
  if (!looks.empty()) return "; " + join(looks, ", ") + ": add " + join(options, " ");
  if (!format.decimal_comma || has_commas || !splits_a_number(lines, '.')) return "";
  return "; its decimals look written with a point: leave out --decimal-comma";
}

}  // namespace npdr::pipeline
