/// Proposal artefacts: theta of a round's simulations.
#pragma once

#include "inference/prior.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/work_folder.h"

namespace npdr::pipeline {

struct Proposal {
  RowMatrix theta;                              ///< (N, D)
  std::vector<inference::Marginal> parameters;  ///< of theta's columns; not read
};
void describe(Layout f, Proposal& proposal);

/// The dataset theta (N, D), in the order of the prior. Throws InputError.
h5::Dataset open_proposal(const ArtefactFile& proposal);

/// Rows [begin, end) of it. Throws InputError for one that isn't finite.
RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows);

}  // namespace npdr::pipeline
