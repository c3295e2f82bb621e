/// The clock of a recording, the column of times of a CSV file: even, or to be resampled.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/import/csv_rows.h"

namespace npdr::pipeline {

/// Steps between the times of a file's rows [s].
struct TimeSteps {
  double shortest, median, longest;
};

TimeSteps steps_of(const std::vector<double>& times);

/// Time between two rows of all files [s]: `given`, else the mean of the first one's equally spaced
/// times. None of them may be further than 5 % of it from where it belongs, and files and `given`
/// must agree to 0.1 %, and what rounded times leave open: 10 % of a step over the whole rollout.
/// Throws InputError, which says how uneven the clock is, and the option that helps.
double even_step(const std::vector<CsvRows>& files, const std::optional<double>& given);

/// A rollout at the times of such rows on an even grid t_0 + k dt, which begins at the first time
/// and ends before, or at, the last one. States are interpolated linearly. An action is held from
/// its time to the next one, so each step gets the one that is held in its middle: the one that
/// acts for most of it, also when times are rounded. `dt` [s] > 0. Throws InputError unless the
/// times increase, without a gap of more than ten steps: dt, or the usual one where that is longer;
/// for a dt longer than the whole duration, and for one that makes thousands of rows of each.
Rollout resampled(const CsvRows& rows, const Rollout& rollout, double dt);

}  // namespace npdr::pipeline
