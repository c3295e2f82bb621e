/// Whole turns in the angles of CSV files: found, and taken out.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "pipeline/import/csv_rows.h"

namespace npdr::pipeline {

/// Adds whole turns to the states with these labels, in all files, so that no step is longer than
/// half a turn. Returns what was done, in a sentence each. Throws InputError for labels that no
/// state has, and for units other than [rad] and [deg].
Findings unwrap_turns(std::vector<CsvRows>& files, const std::vector<std::string>& labels);

/// The states that jump by whole turns: where first, and the option that helps.
Findings find_turns(const std::vector<CsvRows>& files);

}  // namespace npdr::pipeline
