/// The rows of a dataset that take the place of simulations.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types.h"
#include "inference/prior.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/config/study.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// `count` different rows of `num_rows`: the first ones of a random order that depends on the seed
/// and on num_rows alone. So a larger count keeps the rows of a smaller one, and any part of them
/// is like the whole, also of a file that is sorted.
std::vector<Index> dataset_rows(std::uint64_t seed, Index num_rows, Index count);

/// The study's dataset, with the prior's parameters and the study's features. Throws InputError.
DatasetFile open_dataset(const Study& study);

/// Rows of x (n, F) as a simulator would hand them back: out of limits where theta (n, D) is
/// outside of the prior's support, diverged where an x isn't finite.
sim::Trajectories as_simulated(const inference::Prior& prior, const RowMatrix& theta,
                               const RowMatrix& x);

}  // namespace npdr::pipeline
