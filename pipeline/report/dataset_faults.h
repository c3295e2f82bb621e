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

/// Looks at the rows that `methods` train on with `seed`: at 10,000 of them at most, each theta
/// once unless it is rounded to six digits, for theta that isn't distributed as the prior, by
/// Kolmogorov-Smirnov of F(theta), which is uniform for draws of the prior, and by the largest
/// correlation of two of them; one without fault is accused by each with probability 1e-4. Grave
/// where F is off by 0.05, and half of a step of theta that has few values, or the correlation is
/// above 0.2. Where a hundredth of theta lies at an end of the prior, that is grave, too: its
/// density ends there, and grids have theirs there. At 100,000 for rows that are there twice: they
/// count several times, and judge as validation what they have taught. Grave where they are a
/// twentieth, and theta isn't rounded to six digits. Nothing of a source that simulates. Throws
/// InputError for a damaged dataset.
DatasetFaults faults_of_dataset(const Plan& plan, const std::vector<std::string>& methods,
                                std::uint64_t seed);

}  // namespace npdr::pipeline
