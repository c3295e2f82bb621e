/// One CSV file of a recording, as it was written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/import/csv_options.h"
#include "pipeline/import/rate_pairs.h"

namespace npdr::pipeline {

/// Row t, from 0, stands in line t + 2 of the file.
struct CsvRows {
  std::string name;               ///< of the file
  std::vector<Channel> states;    ///< with the units that were asked for, else the file's
  std::vector<Channel> actions;   ///< the same
  std::vector<RatePair> lacking;  ///< rates without a column: to be computed, 0 until then
  std::string time;               ///< label of the column of times; empty: none
  std::string time_place;         ///< "column 1 't'"
  std::vector<double> times;      ///< [s], a row each; empty without such a column
  RowMatrix state_values;         ///< (T + 1, C)
  RowMatrix action_values;        ///< (T, A); those of the last row are ignored, and may be empty
  bool has_line_end = true;       ///< of the last line, which a file lacks that was cut
  std::vector<std::string> ignored;  ///< labels of columns that nobody asked for
};

/// Reads a header line of `label [unit]` fields and at least two rows; multiplies columns by their
/// scales. Throws InputError with file, line and column, and the option that helps.
CsvRows read_csv_rows(const std::filesystem::path& path, const CsvOptions& options);

}  // namespace npdr::pipeline
