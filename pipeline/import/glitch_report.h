/// The words of what sensors got wrong in CSV files.
#pragma once

#include <string>
#include <vector>

#include "pipeline/import/csv_options.h"
#include "pipeline/import/csv_rows.h"

namespace npdr::pipeline {

/// A sentence for each file and channel with glitches (glitches.h): file and line of the first one,
/// how many there are, and what to do. A channel's noise and errors are shares of its largest
/// magnitude, which a glitch sets.
std::vector<std::string> words_of_glitches(const std::vector<CsvRows>& files,
                                           const CsvOptions& options);

/// What is wrong with a position (n) where it leaps (find_lone_steps());
/// "": nothing.
std::string words_of_leap(const std::string& label, const Vector& position, double dt);

}  // namespace npdr::pipeline
