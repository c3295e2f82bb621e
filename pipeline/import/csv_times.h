/// The clock of a recording: the column of times of a CSV file.
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

/// Share of the whole time in steps that are longer than twice the usual one or, where that is
/// longer, `dt` [s].
double share_of_gaps(const std::vector<double>& times, double dt);

/// Time between two rows [s]: `given`, else the mean of equally spaced times. None of them may be
/// further than 5 % of it from where it belongs, and both must agree to 0.1 %, and what rounded
/// times leave open: 10 % of a step over the whole rollout. Throws InputError, which says how
/// uneven the clock is, and the option that helps.
double even_step(const CsvRows& rows, const std::optional<double>& given);

/// Throws InputError unless the file's step agrees with `dt` [s], that of the first file, as
/// well as that.
void require_step(const CsvRows& rows, const std::optional<double>& given, double dt);

/// Throws InputError unless the times increase, without a gap of more than ten steps: `dt` [s], or
/// the usual one where that is longer.
void check_times_to_resample(const CsvRows& rows, double dt);

}  // namespace npdr::pipeline
