/// Rates of change that a recording lacks, computed of its positions.
#pragma once

#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "pipeline/import/rate_pairs.h"

namespace npdr::pipeline {

struct RateOptions {
  Index window = 11;          ///< samples that a slope is taken over
  bool at_rest = false;       ///< rates are 0 at the first states
  bool is_resampled = false;  ///< positions lie on straight lines between those that were recorded
};

/// Sets the rates of `pairs` in every rollout to the slopes of their positions
/// (sim/savitzky_golay.h). Returns a note of each pair, and a warning with rollout and row where
/// slopes over 5 samples differ from these by more than 5 % of the largest rate and by more than
///   7 sigma / dt:
/// the motion bends too much for the window, or a sample near is wrong, missing or repeated. sigma
/// is the largest of the scatter (analysis/scatter.h) of all positions, that of 41 before, around
/// and after the place, and an encoder's count / sqrt(12). White noise gives the difference a
/// standard deviation of at most 1.2 sigma / dt, at the ends. Numbers without noise whose speed
/// jumps time and again look like counts, and aren't told; positions that were resampled aren't
/// looked at. Throws InputError for a window that is none, or longer than a rollout.
Findings compute_rates(Target& target, const std::vector<RatePair>& pairs,
                       const RateOptions& options);

}  // namespace npdr::pipeline
