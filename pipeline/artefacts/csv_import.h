/// Recordings from CSV files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/artefacts/channels.h"

namespace npdr::pipeline {

/// How CSV files become a target.
struct CsvOptions {
  /// Columns to take, by label and in this order; other columns are ignored. An empty unit accepts
  /// the file's, any other must be the file's.
  Channels channels;
  std::optional<double> dt;  ///< [s]; none: from the column 't [s]' or 'time [s]'
  std::string source;        ///< for people; empty: the files' names
};

/// Reads one rollout per file: a header line of `label [unit]` fields, then T + 1 rows, of which
/// row t holds state t and the action that is applied from there to state t + 1. The actions of the
/// last row are ignored and may be empty. Rollouts are named after their files. Times must be
/// equally spaced: none may be further than 5 % of dt from where it belongs. Throws InputError with
/// file, line and column.
Target import_csv(const std::vector<std::filesystem::path>& files, const CsvOptions& options);

}  // namespace npdr::pipeline
