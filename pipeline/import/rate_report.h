/// The words of the check of rates: what is likely wrong with a recording, and its remedy.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "pipeline/import/rate_check.h"
#include "pipeline/import/rate_pairs.h"

namespace npdr::pipeline {

/// What speaks against rates or, where nothing does, notes of what was checked, and what couldn't
/// be. The options that messages name are those of `npdr import`.
///
/// Compares the rates of all `pairs` with the slopes of their positions in every rollout; whole
/// turns that an angle jumps by are left out first. `time`: the label of the column of times, empty
/// where dt was given; `of_options` follows messages that name options. A ratio that all pairs
/// share says that dt is wrong, one near 57.3 that a column is in degrees.
Findings find_in_rates(const Target& target, const std::vector<RatePair>& pairs,
                       const std::string& time, const std::string& of_options = "");

}  // namespace npdr::pipeline
