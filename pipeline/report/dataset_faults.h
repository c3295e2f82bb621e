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

/// Looks at the rows that the first method and `seed` train on; at 10,000 of them at most for theta
/// that isn't distributed as the prior: Kolmogorov-Smirnov of F(theta), which is uniform for draws
/// of the prior; one without fault is accused with probability 1e-4. Grave where F is off by 0.05.
/// And for rows that are there twice, grave where they are a twentieth: they count several times,
/// and judge as validation what they have taught. Nothing of a source that simulates. Throws
/// InputError for a damaged dataset.
DatasetFaults faults_of_dataset(const Plan& plan, const std::string& method, std::uint64_t seed);

}  // namespace npdr::pipeline
