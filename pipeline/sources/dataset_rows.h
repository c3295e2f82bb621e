/// The rows of a dataset that take the place of simulations.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// `count` different rows of `num_rows`: the first ones of a random order that depends on the seed
/// and on num_rows alone. So a larger count keeps the rows of a smaller one, and any part of them
/// is like the whole, also of a file that is sorted.
std::vector<Index> dataset_rows(std::uint64_t seed, Index num_rows, Index count);

/// The study's dataset, with the prior's parameters and the study's features. Throws InputError.
DatasetFile open_dataset(const Study& study);

}  // namespace npdr::pipeline
