/// Recordings from CSV files.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "pipeline/import/csv_rows.h"

namespace npdr::pipeline {

/// A target, and notes of what was done to make it, with what is probably wrong.
struct ImportedRecording {
  Target target;
  Findings findings;
};

/// Reads one rollout per file: a header line of `label [unit]` fields, then T + 1 rows, of which
/// row t holds state t and the action that is applied from there to state t + 1. The actions of the
/// last row are ignored and may be empty. Rollouts are named after their files. Times must be
/// equally spaced, or resampled: none may be further than 5 % of dt from where it belongs. Angles
/// must not jump by whole turns, and rates must be the slopes of what they are the rates of, unless
/// options.check_rates is false. Throws InputError with file, line and column.
ImportedRecording import_csv(const std::vector<std::filesystem::path>& paths,
                             const CsvOptions& options);

/// Cuts all rollouts into pieces of `length` steps, 0: those of the shortest; none: checks that
/// they are equally long. A piece begins at the state that was recorded there, and is a rollout
/// with the name "rollout.piece", where there are several. Returns what came of it, in a sentence.
/// Throws InputError for a rollout with fewer steps, and for lengths that differ, with the option
/// that helps.
Findings cut_rollouts(Target& target, const std::optional<Index>& length);

}  // namespace npdr::pipeline
