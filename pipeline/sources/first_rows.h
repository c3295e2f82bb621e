/// Probes of the rows that a source gives: what is probably wrong with them, said by the first rows
/// of a simulation, hours before all are there.
#pragma once

#include <map>
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

/// That every rollout of x (n, H, T, C), in all rows, begins with the state that the recorded one
/// began in, though that moves in its first step, in some channel about as far as in others. Wanted
/// are the states after each action. Rows that aren't finite don't count.
Findings find_late_states(const sim::Trajectories& x, const Target& recorded);

/// How many of the rows of x (n, F), the first of a simulation, are the same to the last bit though
/// their theta (n, P) differ: all, of eight or more, or three or more where nine tenths of the
/// others are like no other. Rows that aren't finite don't count; the latter isn't said of a single
/// column, which may be censored, and of whole numbers, which may all be 0.
Findings find_same_rows(const RowMatrix& theta, const RowMatrixF& x);

/// Columns of x (n, F) whose deviation is below 10^-6 of their mean, about ten steps of a float,
/// and above the rounding of doubles. As floats, in which rows are kept, such columns tell nothing,
/// and feature transforms take them for constants (inference/feature_transform.h). Rows with NaN
/// and infinities don't count, and fewer than eight aren't judged.
Findings find_lost_precision(const RowMatrix& x, const std::vector<Channel>& columns);

/// Looks over the rows of x, as many at once as there are, for numbers that stand for a failure,
/// such as -999, where rows should hold NaN: columns that hold their smallest or largest number
/// several times, further from all others than these lie apart. What isn't finite doesn't count.
class RepeatedOutliers {
 public:
  explicit RepeatedOutliers(Index num_columns) : columns_(static_cast<std::size_t>(num_columns)) {}

  /// More rows (n, F). Throws ShapeError for another number of columns.
  void observe(const Eigen::Ref<const RowMatrixF>& x);

  /// A warning that names such columns. Throws ShapeError for another number of `columns`.
  Findings find(const std::vector<Channel>& columns) const;

 private:
  struct Column {
    std::map<float, Index> ends;  ///< how often the two smallest and largest numbers are there
    Index num_finite = 0;
  };

  std::vector<Column> columns_;
  Index num_rows_ = 0;
};

/// Repeated outliers in a program's features; the check of all rows at the end finds them again.
Findings find_outliers(const FirstRows& rows);

}  // namespace npdr::pipeline
