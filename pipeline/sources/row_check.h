/// A check of rows that somebody else's simulator gave: a few of them are asked for again.
#pragma once

#include "core/finding.h"
#include "pipeline/sources/row_simulator.h"

namespace npdr::pipeline {

/// Rows of all parameters (n, P), what the simulator gave for them, and the random numbers of
/// row 0.
struct GivenRows {
  const RowMatrix& complete;
  const sim::Trajectories& result;
  StreamId first;
};

/// Simulates two of the rows again, each alone (up to six where one is another), and one of them
/// with other random numbers. Finds rows that differ when they are repeated, noise that all rows of
/// a call share, no noise at all unless `has_noise` says that the study adds some. Fewer than eight
/// good rows aren't judged, and none that are all the same. Throws InputError where rows
/// come in another order than theta's, and what RowSimulator::simulate() throws.
Findings check_rows(RowSimulator& simulator, const GivenRows& rows, bool has_noise);

}  // namespace npdr::pipeline
