/// The words of what sensors got wrong in CSV files.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "pipeline/import/csv_options.h"
#include "pipeline/import/csv_rows.h"

namespace npdr::pipeline {

/// A warning for each file and channel with glitches (glitches.h): file and line of the first one,
/// how many there are, and what to do. A channel's noise and errors are shares of its largest
/// magnitude, which a glitch sets.
Findings find_glitches(const std::vector<CsvRows>& files, const CsvOptions& options);

/// A warning of each position that leaps (find_lone_steps()), but by whole turns, of the first
/// rollout where it does. `names`: of the rollouts.
Findings find_leaps(const Target& recording, const std::vector<std::string>& names);

}  // namespace npdr::pipeline
