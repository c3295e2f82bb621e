/// One CSV file of a recording, unchanged; its clock, the column of times; and options of
/// `npdr import`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/import/rates.h"
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

/// Steps between the times of a file's rows [s].
struct TimeSteps {
  double shortest, median, longest;
};

TimeSteps steps_of(const std::vector<double>& times);

/// Time between two rows of all files [s]: `given`, else the mean of the first one's equally spaced
/// times. None of them may be further than 5 % of it from where it belongs, and files and `given`
/// must agree to 0.1 %, and what rounded times leave open: 10 % of a step over the whole rollout.
/// Throws InputError, which says how uneven the clock is, and the option that helps.
double even_step(const std::vector<CsvRows>& files, const std::optional<double>& given);

/// A rollout at the times of such rows on an even grid t_0 + k dt, which begins at the first time
/// and ends before, or at, the last one. States are interpolated linearly. An action is held from
/// its time to the next one; each step gets the mean of those that are held during it, so that one
/// that is switched between two times of the grid acts for as long as it did. `dt` [s] > 0. Throws
/// InputError unless the times increase, without a gap of more than ten steps: dt, or the usual one
/// where that is longer; for a dt longer than the whole duration, and for one that makes thousands
/// of rows of each.
Rollout resampled(const CsvRows& rows, const Rollout& rollout, double dt);

}  // namespace npdr::pipeline
