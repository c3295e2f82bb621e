/// Classifier two-sample test (Lopez-Paz and Oquab 2017, "Revisiting classifier two-sample tests"):
/// how often a classifier tells from which of two samples a row comes that it hasn't seen. 0.5: the
/// distributions can't be told apart, 1: they don't overlap.
///
/// Computed as the benchmark of simulation-based inference does it (Lueckmann et al. 2021,
/// "Benchmarking simulation-based inference", appendix): columns standardized by mean and deviation
/// of the first sample, a classifier with two hidden layers of 10 D units (mlp_classifier.h), mean
/// accuracy of a five-fold cross-validation over randomly ordered rows.
#pragma once

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

inline constexpr Index kC2stFolds = 5;

/// Accuracy of the classifier.
struct C2st {
  double accuracy = 0.0;  ///< mean over the folds
  Vector fold_accuracy;   ///< (kC2stFolds)
  /// sqrt(a (1 - a) / (2 n)): of the accuracy, for the rows alone; training adds to it.
  double standard_error = 0.0;
};

/// Compares two samples (n, D) with as many rows. Folds run in parallel; the bits depend neither on
/// the number of threads nor on the order of the folds. Throws ShapeError when shapes differ and
/// InputError for fewer than 10 rows, or what isn't finite.
C2st c2st(const RowMatrix& first, const RowMatrix& second, const StreamId& id);

}  // namespace npdr::inference
