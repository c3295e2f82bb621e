/// A method's results as InferenceData: the file that ArviZ and xarray open.
#pragma once

#include <filesystem>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Writes the last posteriors of the only method of the plan, a chain a seed, to `path`
/// (docs/python.md lists the groups). `num_predictions`: draws of each chain whose rollouts are
/// simulated; 0: none. Throws InputError for several methods and for what isn't made yet.
void write_inference_data(const Plan& plan, const std::filesystem::path& path,
                          Index num_predictions);

}  // namespace npdr::pipeline
