/// Probes of the rows that a source gives: what is probably wrong with them, said by the first rows
/// of a simulation, hours before all are there.
#pragma once

#include <vector>

#include "core/finding.h"
#include "pipeline/config/study.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {

/// Rows of all parameters (n, P), what the simulator gave for them, and the random numbers of
/// row 0.
struct GivenRows {
  const RowMatrix& complete;
  const sim::Trajectories& result;
  StreamId first;
};

/// Rows that a study's source gave, and what they were asked by.
struct FirstRows {
  const Study& study;
  const Target& target;                 ///< that they replay
  const std::vector<Channel>& columns;  ///< of x
  RowSimulator& simulator;
  GivenRows given;
};

/// By the probes of a table. Throws as check_rows().
Findings find_in_first_rows(const FirstRows& rows);

/// Simulates two of the rows again, each alone (up to six where one is another), and one of them
/// with other random numbers. Finds rows that differ when they are repeated, noise that all rows of
/// a call share, no noise at all unless `has_noise` says that the study adds some. Fewer than eight
/// good rows aren't judged, and none that are all the same. Throws InputError where rows
/// come in another order than theta's, and what RowSimulator::simulate() throws.
Findings check_rows(RowSimulator& simulator, const GivenRows& rows, bool has_noise);

/// The same of late rows: two are simulated again, the last of them first. Throws as check_rows().
Findings check_late_rows(RowSimulator& simulator, const GivenRows& rows);

/// That all rows of x (n, F) are the same, of eight or more, the first of a simulation. Rows that
/// aren't finite don't count.
Findings find_constant_rows(const RowMatrixF& x);

/// Rows (theta, x) in the order in which they were made, of a user's simulator or a dataset.
struct RowsTogether {
  RowMatrix theta;                     ///< (n, D)
  RowMatrixF x;                        ///< (n, F); of motion some columns
  std::vector<Channel> features = {};  ///< (F); none of motion, whose values may gather somewhere
  std::vector<Index> numbers = {};     ///< (n) of rows; none: they count from 0
};

/// As many rows of `num_values` values each as are looked at: 20,000, or 2^25 values.
Index num_rows_together(Index num_values);

/// By inference/diagnostics/row_faults.h: a stretch of rows that doesn't go with its theta, which
/// is wrong; the same x of different theta, wrong for a twentieth of the rows; numbers in features
/// that stand for failures.
Findings find_apart(const RowsTogether& rows);

/// Columns of x (n, F) whose deviation is below 10^-6 of their mean, about ten steps of a float,
/// and above the rounding of doubles. As floats, in which rows are kept, such columns tell nothing,
/// and feature transforms take them for constants (inference/feature_transform.h). Rows with NaN
/// and infinities don't count, and fewer than eight aren't judged.
Findings find_lost_precision(const RowMatrix& x, const std::vector<Channel>& columns);

/// find_apart() in the features of a program's first rows, which a look at all rows finds again.
Findings find_apart_in_first(const FirstRows& rows);

}  // namespace npdr::pipeline
