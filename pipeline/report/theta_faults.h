/// What is wrong with the parameters of a dataset.
#pragma once

#include <string>
#include <vector>

#include "inference/prior.h"

namespace npdr::pipeline {

struct DatasetFaults {
  std::vector<std::string> faults;  ///< a sentence each
  bool are_grave = false;           ///< posteriors are those of something else
};

/// Looks at theta (n >= 1, D), all of it in the prior, for what draws of that don't have. Of each
/// parameter:
/// - It is the same in all rows: grave.
/// - Its least or largest value lies within 1e-6 of an end of F, where the density of a bounded
///   prior is cut, as that of a grid or of rounded draws does, or is more frequent than others, as
///   that of clipped draws is: told from a fiftieth of the rows on, grave above 0.075.
/// - It is distributed in another way than the prior, by Kolmogorov and Smirnov's test of
///   inference::distance_of_levels(): grave where that is above 0.05.
/// - 0.15 of the rows or more have one value, which is twice as many as others have, or it has less
///   than five.
/// And the pair whose F are correlated most surely: grave above 0.2.
///
/// Draws of the prior are accused by each of the two tests with a probability of 1e-4 at most. Rows
/// of the same theta, which are about as often there each, are one draw, and so are those that
/// share a parameter unless its values are inference::are_chosen(). A design, of 20 different
/// values at most, wasn't drawn: of it every row counts.
DatasetFaults faults_of_theta(const RowMatrix& theta, const inference::Prior& prior);

}  // namespace npdr::pipeline
