#include "pipeline/store/number_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>
#include <unordered_set>

#include "core/constants.h"
#include "core/feature_names.h"
#include "core/printable.h"
#include "core/text.h"
#include "pipeline/store/column_labels.h"

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

constexpr std::size_t kLongestLine = std::size_t{64} << 20;

std::optional<double> parse_number(const std::string& field) {
  if (field == "NA") return kNaN;
  const char* const begin = field.data() + (field.starts_with('+') ? 1 : 0);
  const char* const end = field.data() + field.size();
  double value = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end || begin == end || (begin != field.data() && *begin == '-')) return std::nullopt;
  if (error == std::errc()) return value;
  if (error != std::errc::result_out_of_range) return std::nullopt;
  // Too small or too large for a double: as any other program reads it.
  return std::strtod(begin, nullptr);
}

// What other systems write, and looks like any other file there.
void require_text(const std::string& name, const std::string& line) {
  if (line.find('\0') != std::string::npos) {
    throw InputError(name + ": holds zero bytes, as UTF-16 has them; save it as UTF-8");
  }
  if (line.find('\r') != std::string::npos) {
    throw InputError(name +
                     ": has a carriage return (CR) within a line, must end lines in line feeds (LF "
                     "or CR LF) and have no CR elsewhere");
  }
}

// No-break spaces are blanks, and zero-width ones nothing: nobody sees them.
std::string without_invisible(const std::string& text) {
  const std::string blanks = replaced_all(text, "\xC2\xA0", " ");
  return trimmed(replaced_all(replaced_all(blanks, "\xE2\x80\x8B", ""), "\xEF\xBB\xBF", ""));
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

NumberTable::NumberTable(const std::filesystem::path& path, Header header,
                         const std::optional<CsvFormat>& format)
    : name_(path.string()), format_(format.value_or(CsvFormat{})), has_choice_(format.has_value()) {
  std::error_code unreadable;
  if (std::filesystem::is_directory(path, unreadable)) {
    throw InputError(name_ + ": is a folder, must be a file");
  }
  if (!std::filesystem::is_regular_file(path, unreadable)) {
    throw InputError(
        name_ + (std::filesystem::exists(path, unreadable) ? ": isn't a file" : ": isn't there"));
  }
  stream_.open(path, std::ios::binary);
  if (!stream_) throw InputError(name_ + ": can't be opened; may you read it?");
  if (!next_line()) throw InputError(name_ + ": is empty");
  require_text(name_, line_);
  if (line_.starts_with("\xEF\xBB\xBF")) line_.erase(0, 3);
  fields_ = csv_fields(line_, place(), format_.delimiter);
  num_columns_ = static_cast<Index>(fields_.size());
  is_ahead_ = header == Header::optional &&
              std::ranges::all_of(fields_, [&](const auto& f) { return parse(f).has_value(); });
  if (!is_ahead_) read_header(header);
}

bool NumberTable::next() {
  if (is_ahead_) {
    is_ahead_ = false;
    return true;
  }
  if (!next_line()) return false;
  fields_ = csv_fields(line_, place(), format_.delimiter);
  if (static_cast<Index>(fields_.size()) != num_columns_) {
    fail(fmt::format("has {}, must have {} like the first line{}",
                     counted(std::ssize(fields_), "column"), num_columns_, hint(line_)));
  }
  return true;
}

bool NumberTable::next(std::span<double> row) {
  if (!next()) return false;
  for (std::size_t c = 0; c < fields_.size(); ++c) row[c] = number(c);
  return true;
}

double NumberTable::number(std::size_t column) const {
  const std::string& field = fields_[column];
  const std::optional<double> value = parse(field);
  if (!value) {
    throw problem(column, field.empty() ? "a number; pandas leaves nan empty" : "a number");
  }
  return *value;
}

double NumberTable::finite_number(std::size_t column, const std::string& words) const {
  const std::optional<double> value = parse(fields_[column]);
  if (!value || !std::isfinite(*value)) throw problem(column, words);
  return *value;
}

bool NumberTable::is_missing(std::size_t column) const {
  return fields_[column].empty() || std::isnan(parse(fields_[column]).value_or(0.0));
}

InputError NumberTable::problem(std::size_t column, const std::string& words) const {
  const std::string label = columns_.empty() ? "" : fmt::format(" '{}'", columns_[column].label);
  return InputError(fmt::format("{}: column {}{} = {}, must be {}{}", place(), column + 1, label,
                                quoted(fields_[column]), words, hint(line_)));
}

// The next line that isn't blank, without its end. Blank ones are only allowed at the end.
bool NumberTable::next_line() {
  Index first_blank = 0;
  while (read_line()) {
    ++line_number_;
    const bool is_blank = trimmed(line_).empty();
    if (!is_blank && first_blank == 0) return true;
    if (first_blank == 0) first_blank = line_number_;
    if (is_blank) continue;
    line_number_ = first_blank;
    fail("is empty, but rows follow; remove it");
  }
  return false;
}

// Unlike std::getline(), with a limit: a file of one endless line fits into no memory.
bool NumberTable::read_line() try {
  constexpr int end = std::char_traits<char>::eof();
  std::streambuf& characters = *stream_.rdbuf();
  line_.clear();
  int c = characters.sbumpc();
  if (c == end) return false;
  for (; c != '\n' && c != end; c = characters.sbumpc()) {
    if (line_.size() == kLongestLine) fail("is followed by one of more than 64 MiB");
    line_.push_back(static_cast<char>(c));
  }
  has_line_end_ = c == '\n';
  if (line_.ends_with('\r')) line_.pop_back();
  return true;
} catch (const std::ios_base::failure&) {
  throw InputError(name_ + ": reading failed");
}

// Names and units go on to terminals, tables and keys.
void NumberTable::read_header(Header header) {
  std::unordered_set<std::string> labels;
  std::ranges::transform(fields_, fields_.begin(), without_invisible);
  std::ranges::transform(fields_, fields_.begin(), printable);  // tabs say how they are separated
  if (fields_.front().starts_with("# ")) fields_.front() = trimmed(fields_.front().substr(2));
  for (const std::string& field : fields_) {
    const bool has_units = header == Header::with_units;
    const Channel column = has_units ? parse_channel(field) : parse_feature(field);
    const std::size_t number = columns_.size() + 1;
    if (has_units) require_unit(column, field, number);
    if (column.label.empty()) {
      fail(fmt::format(
          "column {} has no name{}", number,
          number == 1 ? "; leave out what only counts rows (pandas: index=False)" : ""));
    }
    if (!labels.insert(column.label).second) {
      fail(fmt::format("column {} is a second one headed {}", number, quoted(column.label)));
    }
    columns_.push_back(column);
  }
}

// Another delimiter in a label separates what should be two of them.
void NumberTable::require_unit(const Channel& column, const std::string& field,
                               std::size_t number) {
  std::string others = fields_.size() == 1 ? ",;\t" : ";\t";
  std::erase(others, format_.delimiter);
  const bool is_two = column.label.find_first_of(others) != std::string::npos;
  if (!column.label.empty() && !column.unit.empty() && !is_two) return;
  const std::string header = line_;
  read_line();
  fail(fmt::format(
      "column {} is headed {}, must be 'label [unit]', such as 'theta [rad]' or "
      "'gain [1]', with {} between columns{}",
      number, quoted(field), delimiter_name(format_.delimiter), hint(header + "\n" + line_)));
}

std::optional<double> NumberTable::parse(const std::string& field) const {
  if (!format_.decimal_comma) return parse_number(field);
  if (field.find('.') != std::string::npos) return std::nullopt;
  std::string number = field;
  std::ranges::replace(number, ',', '.');
  return parse_number(number);
}

std::string NumberTable::hint(const std::string& lines) const {
  if (has_choice_) return format_hint(lines, format_);
  return lines.find_first_of(";\t|") == std::string::npos ? "" : "; columns are separated by ','";
}

std::string NumberTable::place() const { return fmt::format("{}:{}", name_, line_number_); }

void NumberTable::fail(const std::string& message) const {
  throw InputError(fmt::format("{}: {}", place(), message));
}

std::vector<Index> find_columns(const std::string& where, const std::vector<Channel>& found,
                                const std::vector<Channel>& expected) {
  const std::vector<std::string> labels = labels_of(found);
  std::vector<Index> columns;
  for (const Channel& channel : expected) {
    const auto column = std::ranges::find(labels, channel.label);
    if (column == labels.end()) {
      throw InputError(where + ": " +
                       missing_name("column", shortened(channel.label), few_shortened(labels)));
    }
    const std::string& unit = found[static_cast<std::size_t>(column - labels.begin())].unit;
    if (unit != channel.unit && unit != "1" && channel.unit != "1") {
      throw InputError(fmt::format("{}: column {} is in [{}], must be in [{}]", where,
                                   quoted(shortened(channel.label)), shortened(unit),
                                   channel.unit));
    }
    columns.push_back(column - labels.begin());
  }
  return columns;
}

std::vector<Index> match_columns(const std::string& where, const std::vector<Channel>& found,
                                 const std::vector<Channel>& expected) {
  std::vector<Index> columns = find_columns(where, found, expected);
  if (found.size() == expected.size()) return columns;
  throw InputError(fmt::format("{}: has {}, must have {}: {}", where,
                               counted(std::ssize(found), "column"), expected.size(),
                               join(feature_names(expected))));
}

Finding warning_of_end(const std::string& file) {
  return warning(
      file +
      ": its last line has no end: if the file was cut, maybe within a number, copy it again");
}

}  // namespace npdr::pipeline
