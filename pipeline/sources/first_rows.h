/// What is probably wrong with the first rows of a simulation, said hours before all are there.
#pragma once

#include "core/finding.h"
#include "pipeline/config/study.h"
#include "pipeline/sources/row_check.h"

namespace npdr::pipeline {

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

/// Numbers that stand for a failure (repeated_outlier.h) in features of a program, which a look at
/// all rows finds again.
Findings find_outliers(const FirstRows& rows);

/// That every rollout of x (n, H, T, C), in all rows, begins with the state that the recorded one
/// began in, though that moves in its first step, in some channel about as far as in others. Wanted
/// are the states after each action. Rows that aren't finite don't count.
Findings find_late_states(const sim::Trajectories& x, const Target& recorded);

/// How many of the rows of x (n, F), the first of a simulation, are the same to the last bit though
/// their theta (n, P) differ: all, of eight or more, or three or more where nine tenths of the
/// others are like no other. Rows that aren't finite don't count; the latter isn't said of a single
/// column, which may be censored, and of whole numbers, which may all be 0.
Findings find_same_rows(const RowMatrix& theta, const RowMatrixF& x);

}  // namespace npdr::pipeline
