/// One CSV file of a recording, as it was written, and what `npdr import` does with such files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/import/rate_pairs.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {

/// Samples that a slope is taken over: 0.04 s of 250 Hz, where the slope of an encoder with 2048
/// counts a turn has a noise of 0.06 rad/s and a swing of 2 Hz loses less than 0.1 %.
constexpr Index kRateWindow = 11;

/// A factor for all numbers of a column.
struct ColumnScale {
  std::string label;
  double factor = 1.0;
};

/// How CSV files become a target. Options are done in this order: scales, unwrap, resample,
/// differentiate, check of rates, length.
struct CsvOptions {
  /// Columns to take, by label and in this order; other columns are ignored. An empty unit accepts
  /// the file's, any other must be the file's, but for a column with a scale.
  Channels channels;
  std::optional<double> dt;  ///< [s]; none: from the column of times
  std::string source;        ///< for people; empty: the files' names
  CsvFormat format = {};
  std::vector<ColumnScale> scales = {};  ///< of states, actions and the column of times
  std::vector<std::string> unwrap = {};  ///< states to take jumps of a whole turn from
  std::optional<double> resample = {};   ///< [s] between states of an even grid; none: as they are
  std::optional<Index> differentiate = {};  ///< window [samples] of the slopes that rates are,
                                            ///< which files lack; none: files must have them
  bool at_rest = false;                     ///< rates that are computed are 0 at the first states
  std::optional<Index> length = {};  ///< steps of pieces that rollouts are cut into; 0: those of
                                     ///< the shortest; none: all, as many in every file
  bool check_rates = true;           ///< false: accept rates that aren't slopes
};

/// Row t, from 0, stands in line t + 2 of the file.
struct CsvRows {
  std::string name;                  ///< of the file
  std::vector<Channel> states;       ///< with the units that were asked for, else the file's
  std::vector<Channel> actions;      ///< the same
  std::vector<RatePair> lacking;     ///< rates without a column: to be computed, 0 until then
  std::string time;                  ///< label of the column of times; empty: none
  std::string time_place;            ///< "column 1 't'"
  std::vector<double> times;         ///< [s], a row each; empty without such a column
  Rollout rollout;                   ///< named as the file; the last row's actions are ignored
  bool has_line_end = true;          ///< of the last line, which a file lacks that was cut
  std::vector<std::string> ignored;  ///< labels of columns that nobody asked for
};

/// Reads a header line of `label [unit]` fields and at least two rows; multiplies columns by their
/// scales. Throws InputError with file, line and column, and the option that helps.
CsvRows read_csv_rows(const std::filesystem::path& path, const CsvOptions& options);

}  // namespace npdr::pipeline
