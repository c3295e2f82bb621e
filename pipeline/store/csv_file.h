/// One CSV file of numbers with a header line. Private to the pipeline.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// A table whose header names a channel per column, as `label [unit]`. Reads what spreadsheets
/// write: a byte order mark, CRLF, fields in double quotes, empty lines at the end.
class CsvFile {
 public:
  /// Throws InputError with file and line for an empty or ragged file, a header without units, and
  /// a label that occurs twice.
  explicit CsvFile(const std::filesystem::path& path);

  const std::string& name() const { return name_; }
  const std::vector<Channel>& columns() const { return columns_; }
  Index num_rows() const { return static_cast<Index>(rows_.size()); }

  std::optional<std::size_t> find(const std::string& label) const;

  /// The column of a channel; its unit may be any when the channel's is "". Throws InputError when
  /// there is no such label, with those that there are, or it has another unit.
  std::size_t column_of(const Channel& channel) const;

  /// The number in row `row` (counted from 0) of a column. Throws InputError with file, line and
  /// column for what isn't a finite number.
  double number(Index row, std::size_t column) const;

  /// Whether a field holds nothing, or the word nan.
  bool is_missing(Index row, std::size_t column) const;

 private:
  void read_header(const std::string& line);
  void read_row(const std::string& line, std::size_t line_number);
  std::string place(std::size_t line_number) const;
  [[noreturn]] void fail(std::size_t line_number, const std::string& message) const;

  std::string name_;
  std::vector<Channel> columns_;
  std::vector<std::vector<std::string>> rows_;  // the header is line 1, row i is line i + 2
};

}  // namespace npdr::pipeline
