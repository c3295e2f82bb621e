/// Proposal artefacts: theta of a round's simulations.
#pragma once

#include "inference/prior.h"
#include "pipeline/artefacts/work_folder.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// Writes theta (N, D). Throws Error.
void write_proposal(h5::File& file, const std::vector<inference::Marginal>& prior,
                    const RowMatrix& theta);

/// The dataset theta (N, D), in the order of the prior. Throws InputError.
h5::Dataset open_proposal(const ArtefactFile& proposal);

/// Rows [begin, end) of it. Throws InputError for one that isn't finite.
RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows);

}  // namespace npdr::pipeline
