/// What is wrong with the rows of a dataset.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

struct DatasetFaults {
  std::vector<std::string> faults;  ///< a sentence each
  bool are_grave = false;           ///< posteriors are those of something else
};

/// Looks at the rows that `methods` train on with `seed`; one without fault is accused by each test
/// with probability 1e-4, in which rows of the same theta count as one.
/// - At 10,000 of them at most for theta that isn't distributed as the prior, by Kolmogorov-Smirnov
///   of F(theta), which is uniform for draws of the prior, less half of a step of theta that has
///   few values: grave where F is off by more than 0.05. And by the largest correlation of two
///   parameters' F: grave above 0.2.
/// - At theta within 1e-6 of an end of F, where the prior's density ends, as a grid's has it: told
///   from a fiftieth on, grave above a twentieth.
/// - At 100,000 for rows that are there twice: they count several times, and judge as validation
///   what they have taught. Grave where they are a twentieth, and theta isn't rounded to six
///   digits.
/// Nothing of a source that simulates. Throws InputError for a damaged dataset.
DatasetFaults faults_of_dataset(const Plan& plan, const std::vector<std::string>& methods,
                                std::uint64_t seed);

}  // namespace npdr::pipeline
