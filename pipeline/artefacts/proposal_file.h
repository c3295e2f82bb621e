/// Proposal artefacts: theta of a round's simulations.
///
///   theta  (N, D) float64, attributes labels, units, prior_lower, prior_upper
#pragma once

#include "pipeline/artefacts/work_folder.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// The dataset theta (N, D), in the order of the prior. Throws InputError.
h5::Dataset open_proposal(const ArtefactFile& proposal);

/// Rows [begin, end) of it. Throws InputError for one that isn't finite.
RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows);

}  // namespace npdr::pipeline
