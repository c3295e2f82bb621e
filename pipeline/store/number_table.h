/// CSV files of numbers that are read row by row, so that their length costs no memory.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// Numbers, separated by commas, a line a row; all rows are as long as the first. A first line with
/// a field that isn't a number is a header: it names each column as `label` or `label [unit]`.
/// Accepts a byte order mark, CRLF, fields in double quotes, spaces around fields and empty lines
/// at the end.
class NumberTable {
 public:
  /// Throws InputError for what can't be opened, is empty, or has a header with an empty or
  /// repeated label.
  explicit NumberTable(const std::filesystem::path& path);

  const std::string& name() const { return name_; }
  bool has_header() const { return !columns_.empty(); }
  /// As the header names them; empty without one.
  const std::vector<Channel>& columns() const { return columns_; }
  Index num_columns() const { return num_columns_; }

  /// The next row, num_columns() values; false at the end. NaN (also `NA`) and infinities are read
  /// as such. Throws InputError with file, line and column for anything else that isn't a number, a
  /// row of another length, and a line of more than 64 MiB.
  bool next(std::span<double> row);

  /// Throws InputError with file, line and column unless all values of the row that next() has
  /// just given are finite.
  void require_finite(std::span<const double> row) const;

 private:
  bool next_line();
  bool read_line();
  double number(std::size_t column) const;
  std::string column_name(std::size_t column) const;
  void read_header();
  std::string place() const;
  [[noreturn]] void fail(const std::string& message) const;

  std::string name_;
  std::ifstream stream_;
  std::string line_;
  Index line_number_ = 0;
  std::vector<std::string> fields_;
  bool has_fields_ = false;  // of a row that has been split, but not handed out
  std::vector<Channel> columns_;
  Index num_columns_ = 0;
};

/// The column of each of the `expected` labels among those that a file has, in whatever order they
/// are. A unit 1 may also be one that nobody has written down. Throws InputError, beginning with
/// `where`, when there is no such label, or it is in another unit.
std::vector<Index> find_columns(const std::string& where, const std::vector<Channel>& found,
                                const std::vector<Channel>& expected);

/// The same where the file must have no other columns.
std::vector<Index> match_columns(const std::string& where, const std::vector<Channel>& found,
                                 const std::vector<Channel>& expected);

}  // namespace npdr::pipeline
