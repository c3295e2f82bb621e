/// Check that a recorded rate is the slope of the recorded position, and words for likely faults of
/// a recording where that fails.
///
/// The slope of a line through a window of positions (Savitzky and Golay 1964) is an average of the
/// rates in the window, sum_j b_j x[t + j] = sum_k g_k v[t + k] (sim/savitzky_golay.h). So both are
/// smoothed alike, and no window biases their ratio. Noise asks for a long window, filters that lag
/// for one longer than their lag, fast motion for a short one: the window is taken whose ratios
/// agree best. Medians make single glitches, and what is left of jumps, mean nothing; these are
/// looked for one by one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"
#include "pipeline/import/rates.h"

namespace npdr::pipeline {

/// Comparison of the positions and rates of one rollout.
struct RateFit {
  Index window = 0;      ///< samples
  double ratio = 0.0;    ///< median of slope / rate, where the rate is large: 1 when all is well
  double scatter = 0.0;  ///< median deviation from it, as a part of it
  double slack = 0.0;    ///< what a short rollout adds to both, when rates lag behind
  /// What few samples a swing may change of the ratio; infinite: rates are coarse.
  double blur = 0.0;
};

enum class RateVerdict {
  agrees,
  scaled,     ///< the ratio isn't 1, but the same everywhere; or -1
  unrelated,  ///< there is no common ratio, or another negative one
};

/// Fewest samples that are judged.
constexpr Index kFewestSamples = 30;

/// Compares positions (n) with rates (n), dt [s] apart. None when nothing can be said: fewer than
/// kFewestSamples, or neither stands out of the noise of both.
std::optional<RateFit> fit_rate(const Vector& position, const Vector& rate, double dt);

/// A ratio may differ from 1 by 15 %, and by its scatter and slack: rates that come from filters,
/// and coarse encoders, pass. More scatter than half the ratio, and the slack, is none of a rate.
RateVerdict verdict_of(const RateFit& fit);

/// Steps t -> t + 1 of positions (n), dt [s] apart, that their rates (n) know nothing of: what is
/// left of a step without the rate is more than a quarter of the range of the positions, and stands
/// out of what is left of all others, as of the steps beside it. An angle that wraps at half a
/// turn, samples that are missing or stand still, numbers in place of none. None where fewer than
/// kFewestSamples are there, and none of an encoder's single counts.
std::vector<Index> find_leaps(const Vector& position, const Vector& rate, double dt);

/// What speaks against rates or, where nothing does, notes of what was checked, and what couldn't
/// be. The options that messages name are those of `npdr import`.
///
/// Compares the rates of all `pairs` with the slopes of their positions in every rollout; whole
/// turns that an angle jumps by are left out first. `time`: the label of the column of times, empty
/// where dt was given; `of_options` follows messages that name options. A ratio that all pairs
/// share says that dt is wrong, one near 57.3 that a column is in degrees. Rates that agree are
/// wrong, too, where all rollouts, of 300 samples or more in all, share a ratio to 0.015 that is
/// further from 1 than 0.015 plus twice the scatter and the blur of each.
Findings find_in_rates(const Target& target, const std::vector<RatePair>& pairs,
                       const std::string& time, const std::string& of_options = "");

/// Words for a recording that is imported without these checks. `pairs`: rates that were measured.
Finding note_of_unchecked(const Target& target, const std::vector<RatePair>& pairs);

}  // namespace npdr::pipeline
