/// Formats of files; CSV files of numbers that are read row by row, so that their length costs no
/// memory.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/error.h"
#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// The formats of files that other programs read and write.
enum class FileFormat { csv, hdf5 };
constexpr auto enum_table(FileFormat) {
  return std::to_array<EnumRow<FileFormat>>({{FileFormat::csv, "csv"}, {FileFormat::hdf5, "hdf5"}});
}

/// How a file separates its columns and writes its numbers.
struct CsvFormat {
  char delimiter = ',';
  bool decimal_comma = false;  ///< 1,5 is one and a half; the delimiter is another then
};

/// The format of --delimiter (',', ';', '|' or "tab") and --decimal-comma. Throws InputError for
/// another, and for commas that would both separate columns and begin decimals.
CsvFormat parse_csv_format(const std::string& delimiter, bool decimal_comma);

/// "commas", "';'", "tabs".
std::string delimiter_name(char delimiter);

/// The fields of a line, trimmed (RFC 4180, except that a field can't hold a line break). Throws
/// InputError, which begins with `where`, when the last quote isn't closed.
std::vector<std::string> csv_fields(const std::string& line, const std::string& where,
                                    char delimiter = ',');

/// The end of a message about lines in another format: what they look like, and the options of the
/// command line that read them so; or "".
std::string format_hint(const std::string& lines, const CsvFormat& format);

/// Whether the first line of a table names its columns.
enum class Header {
  optional,    ///< where one of its fields isn't a number: as `label` or `label [unit]`
  with_units,  ///< always, as `label [unit]`
};

/// Numbers, separated by commas unless a format says otherwise, a line a row; all rows are as long
/// as the first line. Accepts a byte order mark, CRLF, fields in double quotes, spaces around
/// fields, empty lines at the end, and numpy's `# ` before a header. What isn't printable in the
/// header (core/printable.h) is replaced. All messages begin with file and line.
class NumberTable {
 public:
  /// `format`: as chosen on a command line, whose options messages then name; none: commas and
  /// decimal points. Throws InputError for what can't be read, is empty, UTF-16 or without line
  /// feeds, and for a header with an empty or repeated label, or without a unit that it must have.
  explicit NumberTable(const std::filesystem::path& path, Header header = Header::optional,
                       const std::optional<CsvFormat>& format = {});

  const std::string& name() const { return name_; }
  bool has_header() const { return !columns_.empty(); }
  /// Columns as the header names them; empty without one.
  const std::vector<Channel>& columns() const { return columns_; }
  Index num_columns() const { return num_columns_; }

  /// Goes on to the next row; false at the end. Throws InputError for a row of another length, an
  /// empty line between rows, and a line of more than 64 MiB.
  bool next();

  /// The same, and reads its numbers.
  bool next(std::span<double> row);

  /// The number in a column of this row; NaN (also `NA`) and infinities are read as such. Throws
  /// InputError with line and column for anything else that isn't a number.
  double number(std::size_t column) const;

  /// The same; throws for what isn't finite, too: it must be `words`.
  double finite_number(std::size_t column, const std::string& words = "a finite number") const;

  /// Whether the line that was read last ends, as all do of a file that was written to its end.
  bool has_line_end() const { return has_line_end_; }

  /// Whether a column of this row holds nothing, or NaN.
  bool is_missing(std::size_t column) const;

  /// The error that a column of this row must be `words`, for a caller to throw.
  InputError problem(std::size_t column, const std::string& words) const;

 private:
  bool next_line();
  bool read_line();
  void read_header(Header header);
  void require_unit(const Channel& column, const std::string& field, std::size_t number);
  std::optional<double> parse(const std::string& field) const;
  std::string hint(const std::string& lines) const;
  std::string place() const;
  [[noreturn]] void fail(const std::string& message) const;

  std::string name_;
  CsvFormat format_;
  bool has_choice_;  // of the format
  std::ifstream stream_;
  std::string line_;
  bool has_line_end_ = false;
  Index line_number_ = 0;
  std::vector<std::string> fields_;
  bool is_ahead_ = false;  // the fields of the first row have been read, but not handed out
  std::vector<Channel> columns_;
  Index num_columns_ = 0;
};

/// The column of each of the `expected` labels among those that a file has. A unit 1 may also be
/// one that nobody has written down. Throws InputError for a label that is missing or in another
/// unit.
std::vector<Index> find_columns(const std::string& where, const std::vector<Channel>& found,
                                const std::vector<Channel>& expected);

/// The same where the file must have no other columns.
std::vector<Index> match_columns(const std::string& where, const std::vector<Channel>& found,
                                 const std::vector<Channel>& expected);

/// Of a file without has_line_end().
Finding warning_of_end(const std::string& file);

}  // namespace npdr::pipeline
