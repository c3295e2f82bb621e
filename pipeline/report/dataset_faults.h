/// What is wrong with the rows of a dataset.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/plan.h"
#include "pipeline/report/theta_faults.h"

namespace npdr::pipeline {

/// Looks at the rows that `methods` train on with `seed`.
/// - At theta of 10,000 of them at most, by faults_of_theta().
/// - At 100,000 for rows that are there twice: they count several times, and judge as validation
///   what they have taught. Grave where they are a twentieth, and ten times as many as are
///   expected of rows that were drawn by themselves, given how many values each parameter has. None
///   where x of the same theta is mostly another, so that some of it, such as counts, may agree by
///   chance.
/// Nothing of a source that simulates. Throws InputError for a damaged dataset.
DatasetFaults faults_of_dataset(const Plan& plan, const std::vector<std::string>& methods,
                                std::uint64_t seed);

}  // namespace npdr::pipeline
