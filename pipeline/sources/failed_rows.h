/// Rows that a command couldn't simulate, by its own words.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/types.h"

namespace npdr::pipeline {

/// Reads the file of NPDR_FAILED, a line for each row that failed: its number in theta from 0, a
/// blank, and why. Gives why by row, as the first line about it says; none where there is no such
/// file. Throws InputError where it is no file, can't be read, or has a line of another kind or of
/// none of `num_rows` rows.
std::map<Index, std::string> read_failed_rows(const std::filesystem::path& path, Index num_rows);

}  // namespace npdr::pipeline
