/// Whole turns in the angles of CSV files: found, and taken out.
#pragma once

#include <string>
#include <vector>

#include "pipeline/import/csv_rows.h"

namespace npdr::pipeline {

/// Adds whole turns to the states with these labels, in all files, so that no step is longer than
/// half a turn. Returns what was done, in a sentence each. Throws InputError for labels that no
/// state has, and for units other than [rad] and [deg].
std::vector<std::string> unwrap_turns(std::vector<CsvRows>& files,
                                      const std::vector<std::string>& labels);

/// The states that jump by whole turns: where first, and the option that helps.
std::vector<std::string> turn_problems(const std::vector<CsvRows>& files);

}  // namespace npdr::pipeline
